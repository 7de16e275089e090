#include "core/transport/tensor_file.h"

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <optional>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"

namespace rimlight {
namespace {

static_assert(std::endian::native == std::endian::little, "tensor files are little-endian");

constexpr std::int64_t kMostExact = std::int64_t{1} << 53;  // JSON numbers are exact up to here
constexpr std::string_view kPaddingPrefix = "padding.";
constexpr std::size_t kMostDimensions = 8;

/// In the order of ElementType.
const std::vector<std::string> kTypeNames = {"U8", "U16", "U32", "U64", "F16", "F32", "F64"};

struct Entry {
  ElementType type = ElementType::u8;
  std::vector<std::size_t> shape;
  std::size_t begin = 0, end = 0;  // bytes of the file
};

Entry read_entry(const JsonReader& json, std::size_t data_begin, std::size_t data_bytes) {
  json.allow_only({"dtype", "shape", "data_offsets"});
  Entry entry;
  entry.type = static_cast<ElementType>(json.member("dtype").one_of(kTypeNames));
  std::optional<std::size_t> bytes = element_size(entry.type);
  for (const JsonReader& side : json.member("shape").elements(0, kMostDimensions)) {
    entry.shape.push_back(static_cast<std::size_t>(side.integer(0, kMostExact)));
    if (bytes) bytes = checked_product(*bytes, entry.shape.back());
  }
  const auto limit = static_cast<std::int64_t>(data_bytes);
  const auto offsets = json.member("data_offsets").elements(2, 2);
  const auto begin = static_cast<std::size_t>(offsets[0].integer(0, limit));
  const auto end =
      static_cast<std::size_t>(offsets[1].integer(static_cast<std::int64_t>(begin), limit));
  if (!bytes || *bytes != end - begin) {
    json.fail("data_offsets that span " + type_name(entry.type) + " times the shape");
  }
  entry.begin = data_begin + begin;
  entry.end = data_begin + end;
  if (entry.begin % element_size(entry.type) != 0) json.fail("data aligned to its type");
  return entry;
}

/// Sorted by their begin, tensors must follow each other from the first data byte to the last: no
/// overlap, no hole, nothing left over.
void check_contiguous(const std::map<std::string, Entry>& entries, std::size_t data_begin,
                      std::size_t file_bytes, const std::string& source) {
  std::vector<std::pair<const std::string*, const Entry*>> sorted;
  sorted.reserve(entries.size());
  for (const auto& [name, entry] : entries) sorted.emplace_back(&name, &entry);
  std::ranges::sort(
      sorted, {}, [](const auto& item) { return std::pair(item.second->begin, item.second->end); });
  std::size_t at = data_begin;
  for (const auto& [name, entry] : sorted) {
    if (entry->begin != at) {
      throw Error(source + ": tensor " + quote(*name),
                  "data from byte " + std::to_string(entry->begin),
                  "from byte " + std::to_string(at) + ", without overlap or hole");
    }
    at = entry->end;
  }
  if (at != file_bytes) {
    throw Error(source, std::to_string(file_bytes - at) + " bytes behind the last tensor", "none");
  }
}

}  // namespace

const std::string& type_name(ElementType type) {
  return kTypeNames[static_cast<std::size_t>(type)];
}

std::size_t element_size(ElementType type) {
  constexpr std::size_t kSizes[] = {1, 2, 4, 8, 2, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) {
  return XXH64(bytes.data(), bytes.size(), seed);
}

std::string hash_text(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
  return text;
}

std::uint64_t read_hash(const JsonReader& json) {
  const std::string text = json.string();
  constexpr std::string_view kDigits = "0123456789abcdef";
  if (text.size() != 16 || text.find_first_not_of(kDigits) != std::string::npos) {
    json.fail("16 hexadecimal digits");
  }
  std::uint64_t hash = 0;
  for (const char digit : text) hash = hash << 4 | kDigits.find(digit);
  return hash;
}

nlohmann::json TensorFileSummary::to_json() const {
  nlohmann::json hashes = nlohmann::json::array();
  for (const std::uint64_t hash : block_hashes) hashes.push_back(hash_text(hash));
  return {{"bytes", bytes}, {"xxh64", std::move(hashes)}};
}

TensorFileSummary TensorFileSummary::from_json(const JsonReader& json) {
  json.allow_only({"bytes", "xxh64"});
  TensorFileSummary summary;
  summary.bytes = static_cast<std::uint64_t>(json.member("bytes").integer(0, kMostExact));
  const std::size_t blocks = (summary.bytes + kHashedBlock - 1) / kHashedBlock;
  for (const JsonReader& hash : json.member("xxh64").elements(blocks, blocks)) {
    summary.block_hashes.push_back(read_hash(hash));
  }
  return summary;
}

struct TensorFile::State {
  std::string source;
  MappedFile file;
  TensorFileSummary expected;
  std::map<std::string, Entry> entries;          // padding left out
  std::unique_ptr<std::atomic<bool>[]> checked;  // per block: hashed and found right

  State(const std::filesystem::path& path, TensorFileSummary expected_)
      : source(path.string()), file(path), expected(std::move(expected_)) {
    const std::size_t blocks = (expected.bytes + kHashedBlock - 1) / kHashedBlock;
    RIMLIGHT_CHECK_EQ(expected.block_hashes.size(), blocks);
    checked = std::make_unique<std::atomic<bool>[]>(blocks);
    if (file.bytes().size() != expected.bytes) {
      throw Error(source, std::to_string(file.bytes().size()) + " bytes",
                  std::to_string(expected.bytes) + " bytes");
    }
    read_header();
  }

  std::span<const std::byte> block(std::size_t index) const {
    const std::size_t begin = index * kHashedBlock;
    return file.bytes().subspan(begin, std::min(kHashedBlock, file.bytes().size() - begin));
  }

  enum class Known { trusted, hashed_again };

  /// Hashes the blocks that hold bytes [begin, end). Two threads may hash the same block at once:
  /// that costs time and harms nothing. The first wrong block is told, whoever found it.
  void check(std::size_t begin, std::size_t end, Known known) const {
    if (begin == end) return;
    const std::size_t first = begin / kHashedBlock;
    std::vector<std::uint8_t> wrong((end - 1) / kHashedBlock + 1 - first);
    parallel_for(wrong.size(), [&](std::size_t i) {
      const std::size_t index = first + i;
      if (known == Known::trusted && checked[index].load(std::memory_order_relaxed)) return;
      wrong[i] = hash_bytes(block(index), index) != expected.block_hashes[index];
      if (wrong[i] == 0) checked[index].store(true, std::memory_order_relaxed);
    });
    const auto found = std::ranges::find(wrong, 1);
    if (found != wrong.end()) fail_block(first + static_cast<std::size_t>(found - wrong.begin()));
  }

  [[noreturn]] void fail_block(std::size_t index) const {
    throw Error(source + ": block " + std::to_string(index) + " (from byte " +
                    std::to_string(index * kHashedBlock) + ")",
                "hash " + hash_text(hash_bytes(block(index), index)),
                "hash " + hash_text(expected.block_hashes[index]));
  }

  void read_header() {
    const auto bytes = file.bytes();
    std::uint64_t length = 0;
    if (bytes.size() < sizeof length) {
      throw Error(source, std::to_string(bytes.size()) + " bytes", "a tensor file's header");
    }
    check(0, sizeof length, Known::trusted);
    std::memcpy(&length, bytes.data(), sizeof length);
    const std::size_t most = std::min(kMostHeaderBytes, bytes.size() - sizeof length);
    if (length > most) {
      throw Error(source + ": header length", std::to_string(length),
                  "at most " + std::to_string(most));
    }
    const std::size_t data_begin = sizeof length + length;
    check(0, data_begin, Known::trusted);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + sizeof length,
                                length);
    const std::string where = source + ": header";
    const nlohmann::json header = parse_json(text, where);
    for (const auto& [name, json] : JsonReader(header, where).members()) {
      if (name == "__metadata__") continue;
      entries.emplace(name, read_entry(json, data_begin, bytes.size() - data_begin));
    }
    check_contiguous(entries, data_begin, bytes.size(), source);
    std::erase_if(entries, [](const auto& item) { return item.first.starts_with(kPaddingPrefix); });
  }

  const Entry& entry(const std::string& name) const {
    const auto found = entries.find(name);
    if (found != entries.end()) return found->second;
    throw Error(source, "no tensor " + quote(name), "the tensor " + quote(name));
  }
};

TensorFile::TensorFile(const std::filesystem::path& path, TensorFileSummary expected)
    : state_(std::make_unique<State>(path, std::move(expected))) {}
TensorFile::~TensorFile() = default;
TensorFile::TensorFile(TensorFile&&) noexcept = default;

std::uint64_t TensorFile::byte_count() const { return state_->expected.bytes; }

bool TensorFile::has(const std::string& name) const { return state_->entries.contains(name); }

std::vector<std::string> TensorFile::names() const {
  std::vector<std::string> names;
  for (const auto& item : state_->entries) names.push_back(item.first);
  return names;
}

const std::vector<std::size_t>& TensorFile::shape(const std::string& name) const {
  return state_->entry(name).shape;
}

void TensorFile::verify() const {
  state_->check(0, state_->file.bytes().size(), State::Known::hashed_again);
}

std::span<const std::byte> TensorFile::checked_bytes(const std::string& name,
                                                     ElementType type) const {
  const Entry& entry = state_->entry(name);
  if (entry.type != type) {
    throw Error(state_->source + ": tensor " + quote(name), type_name(entry.type), type_name(type));
  }
  state_->check(entry.begin, entry.end, State::Known::trusted);
  return state_->file.bytes().subspan(entry.begin, entry.end - entry.begin);
}

}  // namespace rimlight
