#include "tests/server/test_certificate.h"

#include <openssl/bn.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace rimlight::server::test {
namespace {

namespace fs = std::filesystem;

struct Freed {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(X509_EXTENSION* extension) const { X509_EXTENSION_free(extension); }
  void operator()(BIGNUM* number) const { BN_free(number); }
  void operator()(std::FILE* file) const { std::fclose(file); }
};
template <typename T>
using Owned = std::unique_ptr<T, Freed>;

void extend(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const Owned<X509_EXTENSION> extension(
      X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
  if (!extension || X509_add_ext(certificate, extension.get(), -1) != 1) {
    throw std::runtime_error("no extension " + value);
  }
}

Owned<X509> self_signed(EVP_PKEY* key, const std::string& name) {
  constexpr long kDay = 86400;
  Owned<X509> certificate(X509_new());
  X509_set_version(certificate.get(), X509_VERSION_3);
  const Owned<BIGNUM> serial(BN_new());
  BN_rand(serial.get(), 64, BN_RAND_TOP_ANY, BN_RAND_BOTTOM_ANY);
  BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(certificate.get()));
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -60);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), kDay);
  X509_set_pubkey(certificate.get(), key);
  X509_NAME* const subject = X509_get_subject_name(certificate.get());
  X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>(name.c_str()), -1, -1, 0);
  X509_set_issuer_name(certificate.get(), subject);
  extend(certificate.get(), NID_basic_constraints, "critical,CA:TRUE");
  extend(certificate.get(), NID_subject_alt_name, "DNS:" + name + ",IP:127.0.0.1");
  if (X509_sign(certificate.get(), key, EVP_sha256()) == 0) throw std::runtime_error("not signed");
  return certificate;
}

}  // namespace

TlsFiles make_certificate(const fs::path& folder, const std::string& name) {
  const TlsFiles files{folder / "server.crt", folder / "server.key"};
  const Owned<EVP_PKEY> key(EVP_EC_gen("P-256"));
  const Owned<X509> certificate = self_signed(key.get(), name);
  fs::remove(files.key);
  const Owned<std::FILE> key_file(std::fopen(files.key.c_str(), "w"));
  fs::permissions(files.key, fs::perms::owner_read | fs::perms::owner_write);
  PEM_write_PrivateKey(key_file.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  const Owned<std::FILE> certificate_file(std::fopen(files.certificate.c_str(), "w"));
  PEM_write_X509(certificate_file.get(), certificate.get());
  return files;
}

std::string serial_of(const fs::path& certificate) {
  const Owned<std::FILE> file(std::fopen(certificate.c_str(), "r"));
  const Owned<X509> read(PEM_read_X509(file.get(), nullptr, nullptr, nullptr));
  const Owned<BIGNUM> number(ASN1_INTEGER_to_BN(X509_get_serialNumber(read.get()), nullptr));
  char* const text = BN_bn2hex(number.get());
  std::string serial = text;
  OPENSSL_free(text);
  return serial;
}

}  // namespace rimlight::server::test
