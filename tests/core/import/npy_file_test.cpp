// Arrays as numpy.save writes them, and everything that only pretends to be one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/half.h"
#include "core/import/npy_file.h"
#include "tests/core/import/npy_bytes.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::vector<float> values_of(const std::string& bytes) {
  const NpyArray array(as_bytes(bytes), "a.npy");
  std::vector<float> values(array.count());
  array.read(0, values);
  return values;
}

std::string error_of_bytes(const std::string& bytes) {
  return test::error_of([&] { values_of(bytes); });
}

std::string error_of_header(const std::string& header, std::size_t data_bytes = 24) {
  return error_of_bytes(npy_bytes(header, std::string(data_bytes, '\0')));
}

TEST(NpyFile, ReadsEveryTypeOfEveryVersion) {
  const std::vector<float> numbers = {0, -0.5f, 1, 65504, 0.25f, -3};
  const std::vector<double> doubles(numbers.begin(), numbers.end());
  std::vector<Half> halves;
  for (const float number : numbers) halves.push_back(to_half(number));
  for (const int version : {1, 2, 3}) {
    const std::vector<std::size_t> shape = {2, 3};
    const auto of = [&](const char* type, const std::string& data) {
      return npy_bytes(npy_header(type, shape), data, version);
    };
    EXPECT_EQ(values_of(of("<f4", bytes_of(std::span<const float>(numbers)))), numbers);
    EXPECT_EQ(values_of(of("<f8", bytes_of(std::span<const double>(doubles)))), numbers);
    EXPECT_EQ(values_of(of("<f2", bytes_of(std::span<const Half>(halves)))), numbers);
  }
}

TEST(NpyFile, ReadsAPartOfAFileWhereverItsDataStarts) {
  const std::vector<float> numbers = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  // An even header length keeps version 1 aligned; one byte less does not.
  std::string header = npy_header("<f4", {2, 3, 2});
  const std::string bytes = "\x93NUMPY" + std::string("\1\0", 2) +
                            static_cast<char>(header.size()) + '\0' + header +
                            bytes_of(std::span<const float>(numbers));
  const test::TemporaryFolder folder;
  test::overwrite(folder / "a.npy", bytes);
  const NpyFile file(folder / "a.npy");
  EXPECT_THAT(file.array().shape(), ElementsAre(2, 3, 2));
  EXPECT_EQ(file.array().count(), 12u);
  std::vector<float> middle(5);
  file.array().read(4, middle);
  EXPECT_THAT(middle, ElementsAre(5, 6, 7, 8, 9));
  EXPECT_THAT(test::error_of([&] { NpyFile(folder / "missing.npy"); }), HasSubstr("missing.npy"));
}

TEST(NpyFile, TakesHeadersAsPythonMayWriteThem) {
  const std::string data(24, '\0');
  for (const char* header :
       {"{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)}",
        "{\"shape\":(2,3,),\"descr\":\"<f4\",\"fortran_order\":False,}",
        "  { 'shape' : ( 2L , 3L ) , 'fortran_order' : False , 'descr' : '<f4' }  \n"}) {
    EXPECT_EQ(values_of(npy_bytes(header, data)).size(), 6u) << header;
  }
  EXPECT_EQ(values_of(npy_bytes(npy_header("<f8", {}), std::string(8, '\0'))).size(), 1u);
  EXPECT_EQ(values_of(npy_bytes(npy_header("<f4", {7, 0}), "")).size(), 0u);
}

TEST(NpyFile, BadHeadersNameTheField) {
  struct Case {
    const char *header, *expected;
  };
  const std::vector<Case> cases = {
      {"", "header"},
      {"[1]", "header"},
      {"{'descr': '<f4', 'fortran_order': False}", "no \"shape\""},
      {"{'shape': (6,), 'fortran_order': False}", "no \"descr\""},
      {"{'descr': '<f4', 'shape': (6,)}", "no \"fortran_order\""},
      {"{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (6,)}", "twice"},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (6,), 'x': 1}", "\"x\""},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (6,)} 1", "nothing after"},
      {"{'descr': '>f4', 'fortran_order': False, 'shape': (6,)}", "\">f4\""},
      {"{'descr': '<i4', 'fortran_order': False, 'shape': (6,)}", "\"<i4\""},
      {"{'descr': '|O', 'fortran_order': False, 'shape': (6,)}", "\"|O\""},
      {"{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (6,)}", "\"descr\""},
      {"{'descr': '<f4, 'fortran_order': False, 'shape': (6,)}", "',' or '}'"},
      {"{'descr': '<f4', 'fortran_order': True, 'shape': (6,)}", "ascontiguousarray"},
      {"{'descr': '<f4', 'fortran_order': 0, 'shape': (6,)}", "True or False"},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': 6}", "\"shape\""},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (-6,)}", "a whole number"},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (6.0,)}", "\"shape\""},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (6 1)}", "\"shape\""},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,)}",
       "a whole number"},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (1,1,1,1,1,1,1,1,6)}", "at most 8"},
      {"{'descr': '<f4', 'fortran_order': False, 'shape': (6,", "the end of the header"},
  };
  for (const Case& one : cases) {
    const std::string error = error_of_header(one.header);
    EXPECT_THAT(error, HasSubstr(one.expected)) << one.header;
    EXPECT_THAT(error, HasSubstr("a.npy")) << one.header;
  }
}

TEST(NpyFile, TheShapeIsTheRestOfTheFileToTheByte) {
  const std::string header = npy_header("<f4", {2, 3});
  EXPECT_EQ(error_of_header(header, 24), "no error");
  for (const std::size_t bytes : {0u, 23u, 25u, 48u}) {
    EXPECT_THAT(error_of_header(header, bytes), HasSubstr("2 × 3 of 4 bytes")) << bytes;
  }
  // Products that wrap around to the right size.
  EXPECT_THAT(error_of_header("{'descr': '<f4', 'fortran_order': False, 'shape': "
                              "(4611686018427387910, 4)}",
                              96),
              HasSubstr("\"shape\""));
  EXPECT_THAT(error_of_header("{'descr': '<f8', 'fortran_order': False, 'shape': "
                              "(4294967296, 4294967296)}",
                              0),
              HasSubstr("\"shape\""));
}

TEST(NpyFile, CutFilesAndOtherFormatsAreErrors) {
  const std::string whole = npy_floats({2, 3}, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(error_of_bytes(whole), "no error");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_NE(error_of_bytes(whole.substr(0, size)), "no error") << size;
  }
  EXPECT_THAT(error_of_bytes("PK\3\4 an archive"), HasSubstr("another format"));
  std::string version = whole;
  version[6] = 4;
  EXPECT_THAT(error_of_bytes(version), HasSubstr("4.0"));
  std::string length = npy_bytes(npy_header("<f4", {6}), std::string(24, '\0'), 2);
  length[11] = '\x7f';
  EXPECT_THAT(error_of_bytes(length), HasSubstr("header length"));
}

TEST(NpyFile, NumbersThatAreNotFiniteAreNamedByTheirPlace) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(), -3e20f};
  for (const float value : bad) {
    std::vector<float> values(12, 1.0f);
    values[7] = value;
    EXPECT_THAT(error_of_bytes(npy_floats({2, 3, 2}, values)), HasSubstr("a.npy: [1][0][1]"));
  }
  const std::vector<double> huge = {1, 1e300};
  const std::string bytes =
      npy_bytes(npy_header("<f8", {2}), bytes_of(std::span<const double>(huge)));
  EXPECT_THAT(error_of_bytes(bytes), HasSubstr("1e+300"));
  const std::vector<Half> halves = {0x3c00, 0x7c00};
  EXPECT_THAT(
      error_of_bytes(npy_bytes(npy_header("<f2", {2}), bytes_of(std::span<const Half>(halves)))),
      HasSubstr("[1]"));
}

}  // namespace
}  // namespace rimlight
