#pragma once

#include <filesystem>
#include <string>

#include "server/network/tls_context.h"

namespace rimlight::server::test {

/// Makes a key and a certificate that it signs itself, of that name and 127.0.0.1, for a day; the
/// certificate is its own authority. The key is this user's alone.
TlsFiles make_certificate(const std::filesystem::path& folder,
                          const std::string& name = "localhost");

/// The serial number of a certificate, to tell two apart.
std::string serial_of(const std::filesystem::path& certificate);

}  // namespace rimlight::server::test
