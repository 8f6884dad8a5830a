#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "damage.h"
#include "expect_error.h"
#include "obj_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

struct BadObj {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;  // that the message contains
};

TEST(Obj, BadFilesAreNamedWithPlaceAndRemedy) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<BadObj> bad_obj_files = {
      {"index 0", triangle + "f 0 1 2\n", "io.index_zero", {"line 4", "index 0", "count from 1"}},
      {"out of range", triangle + "f 1 2 4\n", "io.index_out_of_range", {"line 4", "index 4", "3 'v' lines"}},
      {"relative out of range",
       triangle + "f -1 -2 -4\n",
       "io.index_before_first",
       {"line 4", "index -4", "3 'v' lines before it"}},
      {"relative to later lines",
       "f -1 -2 -3\n" + triangle,
       "io.index_before_first",
       {"line 1", "index -1", "0 'v' lines before it"}},
      {"uv out of range",
       triangle + "vt 0 0\nf 1/1 2/2 3/1\n",
       "io.index_out_of_range",
       {"line 5", "index 2", "1 'vt' lines"}},
      {"normal out of range",
       triangle + "f 1//1 2//1 3//1\n",
       "io.index_out_of_range",
       {"line 4", "index 1", "0 'vn' lines"}},
      {"huge index", triangle + "f 1 2 5000000000\n", "io.index_out_of_range", {"line 4", "5000000000"}},
      {"endless index",
       triangle + "f 1 2 99999999999999999999\n",
       "io.bad_corner",
       {"line 4", "99999999999999999999"}},
      {"no index", triangle + "f 1 2 x\n", "io.bad_corner", {"line 4", "'x'"}},
      {"four parts", triangle + "f 1/1/1/1 2 3\n", "io.bad_corner", {"line 4", "'1/1/1/1'"}},
      {"empty face", triangle + "f\n", "io.missing_value", {"line 4", "'v' of 'f'"}},
      {"after CR", with_line_ends(triangle + "f 1 2 x\n", "\r"), "io.bad_corner", {"line 4", "'x'"}},
      {"after CRLF", with_line_ends(triangle + "f 1 2 x\n", "\r\n"), "io.bad_corner", {"line 4", "'x'"}},
      {"two coordinates", "v 0 0 0\nv 1 2\n", "io.missing_value", {"line 2", "'z' of 'v'"}},
      {"too many values", "v 1 2 3 4 5 6 7 8\n", "io.extra_values", {"line 1", "'v'"}},
      {"no number", "v 0 zero 0\n", "io.not_a_number", {"line 1", "'zero'"}},
      {"decimal comma", "v 0,5 1 2\n", "io.decimal_comma", {"line 1", "'0,5'", "decimal point"}},
      {"too large", "v 1e400 1 2\n", "io.number_out_of_range", {"line 1", "'1e400'", "range"}},
      {"short normal", "vn 1 2\n", "io.missing_value", {"line 1", "'z' of 'vn'"}},
      {"empty uv", "vt\n", "io.missing_value", {"line 1", "'u' of 'vt'"}},
      {"no vertices", "# nothing\n", "io.no_vertices", {"no vertices"}},
      {"not text", std::string("v 0 0 0\n\0\1\2", 11), "io.not_text", {"byte 8", "not text"}},
  };
  const TemporaryFolder folder;
  for (const BadObj& bad : bad_obj_files) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.obj", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.obj");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Obj, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  for (std::size_t at = 0; at < rich_obj.size(); ++at) {
    for (const char damage : {'\xFF', '\\', '-', '/', '9', '\r', ' '}) {
      std::string damaged = rich_obj;
      damaged[at] = damage;
      const auto path = folder.file("damaged.obj", damaged);
      try {
        const Mesh mesh = read_mesh(path);
        if (at % 16 == 0) {
          EXPECT_EQ(folder.written(mesh, "out.obj"), damaged);
        }
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
