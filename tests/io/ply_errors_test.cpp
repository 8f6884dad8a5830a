#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "damage.h"
#include "expect_error.h"
#include "ply_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

struct BadPly {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;  // that the message contains
};

std::string ascii_faces(const std::string& row, const std::string& types = "char int") {
  return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list " +
         types + " vertex_indices\nend_header\n0 0 0\n" + row;
}

std::vector<BadPly> bad_ply_files() {
  const std::string binary = rich_binary(false);
  const std::size_t data = rich_header("binary_little_endian").size();
  std::string negative_list = ascii_faces("", "char int");
  negative_list.replace(negative_list.find("ascii"), 5, "binary_little_endian");
  negative_list.replace(negative_list.find("0 0 0\n"), 6,
                        Bytes(false).put({0.f, 0.f, 0.f}).text() + "\xFF\x01\x02\x03");
  return {
      {"no signature",
       "plx\nformat ascii 1.0\n",
       "io.not_this_format",
       {"line 1", "does not begin with 'ply'"}},
      {"header cut off", "ply\nformat ascii 1.0\nelement ver", "io.truncated", {"end_header", "cut off"}},
      {"only the signature", "ply", "io.truncated", {"end_header"}},
      {"no format",
       "ply\nelement vertex 1\nend_header\n",
       "io.unexpected_word",
       {"line 2", "'element'", "format"}},
      {"unknown format",
       "ply\nformat binary_middle_endian 1.0\nend_header\n",
       "io.unexpected_word",
       {"line 2", "binary_middle_endian"}},
      {"unknown version", "ply\nformat ascii 2.0\nend_header\n", "io.unexpected_word", {"line 2", "'2.0'"}},
      {"unknown keyword",
       "ply\nformat ascii 1.0\nelephant\nend_header\n",
       "io.unexpected_word",
       {"line 3", "'elephant'"}},
      {"unknown type",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
       "io.unexpected_word",
       {"line 4", "'half'"}},
      {"property before element",
       "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
       "io.unexpected_word",
       {"line 3", "element"}},
      {"malformed property",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float\nend_header\n",
       "io.malformed_line",
       {"line 4", "property"}},
      {"float list length",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list float int v\nend_header\n",
       "io.non_integer_type",
       {"line 4", "'v'", "length"}},
      {"malformed element",
       "ply\nformat ascii 1.0\nelement vertex\nend_header\n",
       "io.malformed_line",
       {"line 3", "COUNT"}},
      {"negative count",
       "ply\nformat ascii 1.0\nelement vertex -3\nend_header\n",
       "io.bad_count",
       {"line 3", "'-3'"}},
      {"huge count",
       "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n",
       "io.bad_count",
       {"line 3", "99999999999999999999"}},
      {"element twice",
       "ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 0\nend_header\n",
       "io.duplicate_element",
       {"line 4", "twice"}},
      {"no vertices", "ply\nformat ascii 1.0\nend_header\n", "io.no_vertices", {"'vertex'"}},
      {"no z",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
       "io.missing_property",
       {"'z'"}},
      {"lying count",
       ascii_vertices("0 0 0\n", 2000000000),
       "io.too_short",
       {"2000000000", "too short", "cut off"}},
      {"one row short",
       ascii_vertices("0 0 0\n111.1 222.2 333.3\n", 3),
       "io.truncated_records",
       {"line 10", "after 2 of 3", "cut off"}},
      {"one row too many", ascii_vertices("0 0 0\n0 0 0\n", 1), "io.trailing_data", {"line 9", "goes on"}},
      {"too few values",
       ascii_vertices("0 0 0\n1.1234 0\n", 2),
       "io.missing_value",
       {"line 9", "too few", "'z'"}},
      {"too many values", ascii_vertices("0 0 0 0\n"), "io.extra_values", {"line 8", "more values"}},
      {"no number", ascii_vertices("0 zero 0\n"), "io.not_a_number", {"line 8", "y of vertex", "'zero'"}},
      {"decimal comma", ascii_vertices("0,5 1 2\n"), "io.decimal_comma", {"line 8", "'0,5'", "decimal point"}},
      {"too large", ascii_vertices("1e39 1 2\n"), "io.number_out_of_range", {"line 8", "'1e39'", "range"}},
      {"line after CR",
       with_line_ends(ascii_vertices("0 zero 0\n"), "\r"),
       "io.not_a_number",
       {"line 8", "'zero'"}},
      {"line after CRLF",
       with_line_ends(ascii_vertices("0 zero 0\n"), "\r\n"),
       "io.not_a_number",
       {"line 8", "'zero'"}},
      {"negative list", ascii_faces("-1 0 0\n"), "io.bad_length", {"line 11", "vertex_indices", "-1"}},
      {"negative binary list", negative_list, "io.bad_length", {"face 0", "byte", "-1"}},
      {"overlong list", ascii_faces("2000000000 0 0\n", "int int"), "io.bad_length", {"line 11", "2000000000"}},
      {"list cut short", ascii_faces("3 0 0\n"), "io.missing_value", {"line 11", "too few"}},
      {"fractional index",
       ascii_faces("3 0 0 0.5\n"),
       "io.not_a_whole_number",
       {"line 11", "'0.5'", "whole number"}},
      {"index too large",
       ascii_faces("3 0 0 3000000000\n", "uchar uint"),
       "io.index_too_large",
       {"line 11", "3000000000"}},
      {"count out of its type",
       ascii_faces("200 0 0\n", "char int"),
       "io.number_out_of_range",
       {"line 11", "'200'"}},
      {"float indices", ascii_faces("3 0 0 0\n", "uchar float"), "io.non_integer_type", {"vertex_indices"}},
      {"binary cut in the header's elements", binary.substr(0, data + 3), "io.too_short", {"too short"}},
      {"binary cut in the middle",
       binary.substr(0, binary.size() - 20),
       "io.truncated_records",
       {"after 1 of 2 'face'"}},
      {"binary cut at the end", binary.substr(0, binary.size() - 1), "io.truncated_records", {"edge"}},
      {"binary with more",
       binary + "more",
       "io.trailing_data",
       {"byte " + std::to_string(binary.size()), "goes on"}},
  };
}

TEST(Ply, BadFilesAreNamedWithPlaceAndRemedy) {
  const TemporaryFolder folder;
  for (const BadPly& bad : bad_ply_files()) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.ply", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.ply");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Ply, AFileCutAnywhereIsRefusedOrWhole) {
  const TemporaryFolder folder;
  for (const std::string& file : {rich_binary(false), rich_binary(true), rich_ascii()}) {
    // The last digits of the text can be lost without a trace; in binary no byte can.
    const bool ascii = file.find("ascii") != std::string::npos;
    const std::size_t end = ascii ? file.size() - 3 : file.size();
    for (std::size_t size = 1; size < end; ++size) {
      const auto path = folder.file("cut.ply", std::string_view(file).substr(0, size));
      EXPECT_THROW(read_mesh(path), Error) << "cut after " << size << " bytes";
    }
  }
}

TEST(Ply, BinaryPolygonsCutOffAnywhereAreRefused) {
  const TemporaryFolder folder;
  for (const std::string& file : binary_polygon_files()) {
    for (std::size_t size = file.find("end_header"); size < file.size(); ++size) {
      const auto path = folder.file("cut.ply", std::string_view(file).substr(0, size));
      EXPECT_THROW(read_mesh(path), Error) << "cut after " << size << " bytes";
    }
  }
  std::string huge = binary_polygon_files()[1];
  huge[huge.size() - 5] = '\xFF';  // the highest byte of the last index
  const auto path = folder.file("huge.ply", huge);
  expect_error([&] { read_mesh(path); }, "io.index_too_large", {"face 2", "byte"});
}

TEST(Ply, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  for (const std::string& file : {rich_binary(false), rich_ascii()}) {
    for (std::size_t at = 0; at < file.size(); ++at) {
      for (const char damage : {'\xFF', '\0', '-', '9', '\n'}) {
        std::string damaged = file;
        damaged[at] = damage;
        const auto path = folder.file("damaged.ply", damaged);
        try {
          const Mesh mesh = read_mesh(path);
          if (at % 16 == 0) {
            EXPECT_EQ(folder.written(mesh, "out.ply"), damaged);
          }
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
