#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/transport/tensor_file.h"

namespace rimlight {
namespace {

constexpr std::size_t kAlignment = 64;

std::size_t byte_count(const TensorShape& tensor) {
  std::optional<std::size_t> bytes = element_size(tensor.type);
  for (const std::size_t side : tensor.shape) {
    bytes = checked_product(*bytes, side);
    RIMLIGHT_CHECK(bytes.has_value());
  }
  return *bytes;
}

}  // namespace

struct TensorFileWriter::State {
  std::filesystem::path path;
  std::ofstream stream;
  std::vector<std::size_t> tensor_bytes;  // padding tensors too
  std::vector<bool> is_padding;
  std::size_t current = 0;       // the tensor that append() fills
  std::size_t filled = 0;        // bytes of it that are there
  std::vector<std::byte> block;  // what is not written yet: less than kHashedBlock
  TensorFileSummary summary;

  void write_block() {
    summary.block_hashes.push_back(hash_bytes(block, summary.block_hashes.size()));
    summary.bytes += block.size();
    stream.write(reinterpret_cast<const char*>(block.data()),
                 static_cast<std::streamsize>(block.size()));
    if (!stream) throw Error(path.string(), std::strerror(errno), "space to write to");
    block.clear();
  }

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const auto piece = bytes.first(std::min(bytes.size(), kHashedBlock - block.size()));
      block.insert(block.end(), piece.begin(), piece.end());
      bytes = bytes.subspan(piece.size());
      if (block.size() == kHashedBlock) write_block();
    }
  }

  /// Goes to the next tensor that waits for data, and writes the padding before it.
  void skip_full() {
    constexpr std::array<std::byte, kAlignment> kZeros{};
    while (current < tensor_bytes.size() &&
           (is_padding[current] || filled == tensor_bytes[current])) {
      if (is_padding[current]) write(std::span(kZeros).first(tensor_bytes[current]));
      ++current;
      filled = 0;
    }
  }

  /// Adds a tensor to the header; returns where its data end.
  std::size_t add(nlohmann::json& header, const TensorShape& tensor, std::size_t begin,
                  bool padding) {
    const std::size_t bytes = byte_count(tensor);
    RIMLIGHT_CHECK(!header.contains(tensor.name) && tensor.name != "__metadata__");
    header[tensor.name] = {{"dtype", type_name(tensor.type)},
                           {"shape", tensor.shape},
                           {"data_offsets", {begin, begin + bytes}}};
    tensor_bytes.push_back(bytes);
    is_padding.push_back(padding);
    return begin + bytes;
  }

  void write_header(const std::vector<TensorShape>& tensors) {
    nlohmann::json header = nlohmann::json::object();
    std::size_t end = 0;
    for (std::size_t i = 0; i < tensors.size(); ++i) {
      end = add(header, tensors[i], end, false);
      const std::size_t gap = (kAlignment - end % kAlignment) % kAlignment;
      if (gap == 0 || i + 1 == tensors.size()) continue;
      end = add(header, {"padding." + std::to_string(i), ElementType::u8, {gap}}, end, true);
    }
    std::string text = header.dump();
    text.resize((text.size() + sizeof(std::uint64_t) + kAlignment - 1) / kAlignment * kAlignment -
                    sizeof(std::uint64_t),
                ' ');
    RIMLIGHT_CHECK(text.size() <= kMostHeaderBytes);
    const std::uint64_t length = text.size();
    write(std::as_bytes(std::span(&length, 1)));
    write(std::as_bytes(std::span(text)));
    skip_full();
  }
};

TensorFileWriter::TensorFileWriter(const std::filesystem::path& path,
                                   const std::vector<TensorShape>& tensors)
    : state_(std::make_unique<State>()) {
  state_->path = path;
  state_->block.reserve(kHashedBlock);
  // Perhaps somebody still maps a file of that name, of a bake whose removal was killed.
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  state_->stream.rdbuf()->pubsetbuf(nullptr, 0);  // blocks are large enough by themselves
  state_->stream.open(path, std::ios::binary | std::ios::trunc);
  if (!state_->stream) {
    throw Error(path.string(), std::strerror(errno), "a file that can be written");
  }
  state_->write_header(tensors);
}

TensorFileWriter::~TensorFileWriter() = default;

void TensorFileWriter::append(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  RIMLIGHT_CHECK(state_->current < state_->tensor_bytes.size());
  RIMLIGHT_CHECK(bytes.size() <= state_->tensor_bytes[state_->current] - state_->filled);
  state_->write(bytes);
  state_->filled += bytes.size();
  state_->skip_full();
}

TensorFileWriter::Summary TensorFileWriter::finish() {
  RIMLIGHT_CHECK_EQ(state_->current, state_->tensor_bytes.size());
  if (!state_->block.empty()) state_->write_block();
  state_->stream.close();
  if (!state_->stream)
    throw Error(state_->path.string(), std::strerror(errno), "space to write to");
  flush_to_disk(state_->path);
  return state_->summary;
}

}  // namespace rimlight
