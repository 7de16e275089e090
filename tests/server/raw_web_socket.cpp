#include "tests/server/raw_web_socket.h"

#include <stdexcept>

namespace rimlight::server::test {
namespace {

constexpr unsigned char kMask[4] = {0x37, 0xfa, 0x21, 0x3d};

void append_number(std::string& bytes, std::uint64_t number, int size) {
  for (int i = size - 1; i >= 0; --i) bytes += static_cast<char>(number >> (8 * i) & 0xff);
}

}  // namespace

std::string bytes_of(const WireFrame& frame) {
  std::string bytes;
  bytes += static_cast<char>((frame.final ? 0x80u : 0u) | frame.reserved << 4 |
                             static_cast<unsigned>(frame.opcode));
  const unsigned mask_bit = frame.masked ? 0x80 : 0;
  const std::size_t size = frame.payload.size();
  if (size < 126) {
    bytes += static_cast<char>(mask_bit | size);
  } else {
    const bool is_short = size < 65536;
    bytes += static_cast<char>(mask_bit | (is_short ? 126u : 127u));
    append_number(bytes, size, is_short ? 2 : 8);
  }
  if (!frame.masked) return bytes + frame.payload;
  for (const unsigned char byte : kMask) bytes += static_cast<char>(byte);
  const std::size_t start = bytes.size();
  bytes += frame.payload;
  for (std::size_t i = 0; i < size; ++i) {
    bytes[start + i] =
        static_cast<char>(static_cast<unsigned char>(bytes[start + i]) ^ kMask[i % 4]);
  }
  return bytes;
}

std::string close_payload(unsigned code, std::string_view reason) {
  std::string payload;
  append_number(payload, code, 2);
  return payload.append(reason);
}

RawWebSocket::RawWebSocket(std::uint16_t port, const std::string& target) : socket_(port) {
  socket_.send("GET " + target +
               " HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
               "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  std::size_t end = std::string::npos;
  while ((end = received_.find("\r\n\r\n")) == std::string::npos) {
    const std::string more = socket_.read_some();
    if (more.empty()) throw std::runtime_error("no answer to the handshake: " + received_);
    received_ += more;
  }
  if (!received_.starts_with("HTTP/1.1 101 ")) throw std::runtime_error(received_);
  read_ = end + 4;
}

void RawWebSocket::send(const std::string& bytes, std::size_t piece) {
  if (piece == 0) piece = bytes.size();
  for (std::size_t at = 0; at < bytes.size(); at += piece) socket_.send(bytes.substr(at, piece));
}

/// So that `size` bytes wait to be read.
bool RawWebSocket::fill(std::size_t size) {
  while (received_.size() - read_ < size) {
    const std::string more = socket_.read_some();
    if (more.empty()) return false;
    received_ += more;
  }
  return true;
}

std::optional<WireFrame> RawWebSocket::receive() {
  received_.erase(0, std::exchange(read_, 0));
  if (!fill(2)) return std::nullopt;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(received_[i]); };
  WireFrame frame{static_cast<Opcode>(byte(0) & 15), "", (byte(0) & 0x80) != 0, byte(0) >> 4 & 7u,
                  (byte(1) & 0x80) != 0};
  std::uint64_t size = byte(1) & 127;
  std::size_t header = 2;
  if (size >= 126) {
    const std::size_t digits = size == 126 ? 2 : 8;
    header += digits;
    if (!fill(header)) return std::nullopt;
    size = 0;
    for (std::size_t i = 2; i < header; ++i) size = size << 8 | byte(i);
  }
  if (!fill(header + size)) return std::nullopt;
  frame.payload = received_.substr(header, size);
  read_ = header + size;
  return frame;
}

unsigned RawWebSocket::close_code(std::string* before) {
  unsigned code = 0;
  while (const auto frame = receive()) {
    if (code == 0 && frame->opcode == Opcode::close) {
      const auto byte = [&](std::size_t i) {
        return static_cast<unsigned>(static_cast<unsigned char>(frame->payload[i]));
      };
      code = frame->payload.size() < 2 ? 1005 : byte(0) << 8 | byte(1);
    } else if (code == 0 && before != nullptr) {
      *before += frame->payload;
    }
  }
  return code;
}

}  // namespace rimlight::server::test
