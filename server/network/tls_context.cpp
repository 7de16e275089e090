#include "server/network/tls_context.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <string>

#include "core/base/error.h"
#include "core/base/files.h"
#include "server/access/private_file.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;
namespace net = boost::asio;

constexpr std::size_t kLargestFile = 256 * 1024;
constexpr const char* kCertificate = "a chain of certificates in PEM";
constexpr const char* kKey = "a private key in PEM";

std::shared_ptr<net::ssl::context> new_context(net::ssl::context::method method) {
  auto context = std::make_shared<net::ssl::context>(method);
  SSL_CTX* const native = context->native_handle();
  SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  // Of TLS 1.2; those of 1.3 are all good.
  SSL_CTX_set_cipher_list(native, "ECDHE+AESGCM:ECDHE+CHACHA20");
  SSL_CTX_set_options(native, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  // An idle connection keeps no buffers of 16 KiB.
  SSL_CTX_set_mode(native, SSL_MODE_RELEASE_BUFFERS);
  return context;
}

}  // namespace

std::shared_ptr<net::ssl::context> server_tls(const TlsFiles& files) {
  if (files.certificate.empty()) {
    throw Error(files.key.string(), "a key without its certificate", "both");
  }
  if (files.key.empty()) {
    throw Error(files.certificate.string(), "a certificate without its key", "both");
  }
  const std::string chain = read_file(files.certificate, kLargestFile);
  const std::string key = read_private_file(files.key, kLargestFile, kKey);
  auto context = new_context(net::ssl::context::tls_server);
  boost::system::error_code failure;
  context->use_certificate_chain(net::buffer(chain), failure);
  if (failure) throw Error(files.certificate.string(), failure.message(), kCertificate);
  // Else a key with a passphrase would be asked for on the terminal.
  context->set_password_callback([](std::size_t, auto) { return std::string(); });
  context->use_private_key(net::buffer(key), net::ssl::context::pem, failure);
  if (failure) {
    throw Error(files.key.string(), failure.message(),
                std::string(kKey) + ", without a passphrase, of the certificate");
  }
  return context;
}

std::shared_ptr<net::ssl::context> client_tls(const fs::path& authority) {
  auto context = new_context(net::ssl::context::tls_client);
  context->set_verify_mode(net::ssl::verify_peer);
  boost::system::error_code failure;
  if (authority.empty()) {
    context->set_default_verify_paths(failure);
  } else {
    const std::string certificates = read_file(authority, kLargestFile);
    context->add_certificate_authority(net::buffer(certificates), failure);
  }
  if (failure) throw Error(authority.string(), failure.message(), "certificates in PEM");
  return context;
}

}  // namespace rimlight::server
