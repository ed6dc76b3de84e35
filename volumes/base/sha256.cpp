#include "volumes/base/sha256.h"

#include <array>

#include <openssl/evp.h>

#include "volumes/base/error.h"

namespace supple {

struct Sha256::Context {
  EVP_MD_CTX* md = EVP_MD_CTX_new();

  Context() { restart(); }
  ~Context() { EVP_MD_CTX_free(md); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  static void check(int result) {
    if (result != 1) throw Error("SHA-256: OpenSSL refuses the digest");
  }
  void restart() { check(md != nullptr ? EVP_DigestInit_ex(md, EVP_sha256(), nullptr) : 0); }
};

Sha256::Sha256() : m_context(std::make_unique<Context>()) {}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::update(const void* data, std::size_t size) {
  Context::check(EVP_DigestUpdate(m_context->md, data, size));
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest;
  unsigned int length = 0;
  Context::check(EVP_DigestFinal_ex(m_context->md, digest.data(), &length));
  m_context->restart();

  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (unsigned int n = 0; n < length; ++n) {
    text += kDigits[digest[n] >> 4];
    text += kDigits[digest[n] & 15];
  }
  return text;
}

std::string sha256_hex(const void* data, std::size_t size) {
  Sha256 hash;
  hash.update(data, size);
  return hash.hex();
}

}  // namespace supple
