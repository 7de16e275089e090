#pragma once

#include <filesystem>
#include <memory>

namespace boost::asio::ssl {
class context;
}

namespace rimlight::server {

/// What a server shows that it is who it says, in PEM; both empty: it speaks in the clear.
struct TlsFiles {
  std::filesystem::path certificate;  // the chain, the server's own first
  std::filesystem::path key;          // without a passphrase, for this user alone

  bool empty() const { return certificate.empty() && key.empty(); }
};

/// TLS 1.2 with forward secrecy and authenticated encryption, and 1.3; no renegotiation. Throws
/// Error naming the file: one of the two is missing, malformed, a key that others may read
/// (read_private_file), or one of another certificate.
std::shared_ptr<boost::asio::ssl::context> server_tls(const TlsFiles& files);

/// For clients: the server's certificate must be signed by one in `authority`, or by one that this
/// machine trusts when that is empty. Throws Error naming the file.
std::shared_ptr<boost::asio::ssl::context> client_tls(const std::filesystem::path& authority);

}  // namespace rimlight::server
