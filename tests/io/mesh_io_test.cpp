#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stop_token>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "expect_error.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::TemporaryFolder;

const std::string triangle_ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

Mesh triangle() {
  return make_mesh((Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished(),
                   (Triangles(1, 3) << 0, 1, 2).finished());
}

/// Drops the rights of root for its lifetime, because permissions deny root nothing.
class OrdinaryUser {
 public:
  explicit OrdinaryUser(const TemporaryFolder& folder) : was_root_(::geteuid() == 0) {
    constexpr uid_t nobody = 65534;
    if (was_root_) denied_ = ::chown(folder.path().c_str(), nobody, nobody) == 0 && ::seteuid(nobody) == 0;
  }
  OrdinaryUser(const OrdinaryUser&) = delete;
  OrdinaryUser& operator=(const OrdinaryUser&) = delete;
  ~OrdinaryUser() {
    if (was_root_ && ::seteuid(0) != 0) std::abort();
  }
  bool can_be_denied() const { return denied_; }

 private:
  bool was_root_;
  bool denied_ = true;
};

TEST(MeshIo, TheContentsSignatureWinsOverTheExtension) {
  const TemporaryFolder folder;
  EXPECT_EQ(folder.mesh("really_ply.obj", triangle_ply).face_count(), 1);
  EXPECT_EQ(folder.mesh("really_ply.dat", triangle_ply).face_count(), 1);
  const auto path = folder.file("really_obj.ply", triangle_obj);
  expect_error([&] { read_mesh(path); }, "io.not_this_format",
               {"really_obj.ply", "line 1", "'ply'", "extension"});
}

TEST(MeshIo, AFileOfAnotherFormatThanItsNameSaysIsNoted) {
  const TemporaryFolder folder;
  const Mesh off = read_mesh(folder.file("head.stl", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  const std::vector<Note> notes = notes_on_files(off);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].id(), "io.other_format");
  EXPECT_EQ(notes[0].get<std::string>("format"), "OFF");
  EXPECT_EQ(notes[0].get<std::string>("named"), "STL");
  for (const char* name : {"a.ply", "A.PLY"})
    EXPECT_TRUE(notes_on_files(read_mesh(folder.file(name, triangle_ply))).empty());
  EXPECT_TRUE(notes_on_files(triangle()).empty());
}

TEST(MeshIo, ExtensionsAreRecognisedInAnyCase) {
  const TemporaryFolder folder;
  EXPECT_EQ(folder.mesh("A.OBJ", triangle_obj).face_count(), 1);
  EXPECT_EQ(folder.mesh("A.Ply", triangle_ply).face_count(), 1);
}

TEST(MeshIo, UnknownExtensionsAreRefused) {
  const TemporaryFolder folder;
  const auto path = folder.file("mesh.xyz", "0 0 0\n");
  expect_error([&] { read_mesh(path); }, "io.unknown_extension", {"mesh.xyz", "'.xyz'", ".ply, .obj, .off"});
  expect_error([&] { write_mesh(triangle(), folder / "out.xyz"); }, "io.unknown_extension",
               {"out.xyz", "'.xyz'"});
  expect_error([&] { write_mesh(triangle(), folder / "out"); }, "io.no_extension", {"out"});
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(MeshIo, FilesThatCannotBeReadAreNamed) {
  const TemporaryFolder folder;
  expect_error([&] { read_mesh(folder / "missing.ply"); }, "io.file_not_found",
               {"missing.ply", "No such file", "spelling"});
  expect_error([&] { read_mesh(folder.path()); }, "io.is_folder", {});
  const auto file = folder.file("file.ply", triangle_ply);
  expect_error([&] { read_mesh(file / "inside.ply"); }, "io.not_a_folder", {"inside.ply", "not a folder"});
  for (const char* name : {"empty.ply", "empty.obj"}) {
    const auto empty = folder.file(name, "");
    expect_error([&] { read_mesh(empty); }, "io.empty_file", {name});
  }
}

// Reading from them might never end.
TEST(MeshIo, PipesDevicesAndSocketsAreNotRead) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe.ply", socket = folder / "socket.ply";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  ASSERT_EQ(::mknod(socket.c_str(), S_IFSOCK | 0600, 0), 0);
  expect_error([&] { read_mesh(pipe); }, "io.not_a_file", {"pipe.ply", "a pipe"});
  expect_error([&] { read_mesh(socket); }, "io.not_a_file", {"socket.ply", "a socket"});
  expect_error([&] { read_mesh("/dev/zero"); }, "io.not_a_file", {"/dev/zero", "a device"});
}

TEST(MeshIo, APipeTakesAMeshOnceSomebodyReads) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "pipe.ply";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_error([&] { write_mesh(triangle(), pipe); }, "io.nobody_reads", {"pipe.ply"});
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_mesh(triangle(), pipe);
  std::string content(1000, '\0');
  content.resize(
      static_cast<std::size_t>(std::max<ssize_t>(::read(reader, content.data(), content.size()), 0)));
  EXPECT_TRUE(content.starts_with("ply\n")) << content;

  // The pipe is full, and nobody reads on.
  const std::string longer(std::size_t{1} << 20, 'x');
  io::PendingFile pending(pipe, longer, io::Existing::replace);
  std::stop_source stop;
  std::jthread interrupt([&] { stop.request_stop(); });
  expect_error([&] { pending.appear(stop.get_token()); }, "core.cancelled", {});
  ::close(reader);
}

TEST(MeshIo, AStopEndsTheWriteOfAReportIntoAFullPipe) {
  const TemporaryFolder folder;
  const fs::path pipe = folder / "report.json";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const std::string report(std::size_t{1} << 20, 'x');
  std::stop_source stop;
  Context context;
  context.stop_token = stop.get_token();
  // The stop is requested when the pipe has taken something.
  std::jthread interrupt([&] {
    pollfd readable = {reader, POLLIN, 0};
    ::poll(&readable, 1, 60'000);
    stop.request_stop();
  });
  expect_error([&] { write_file_atomically(pipe, report, context); }, "core.cancelled", {});
  ::close(reader);
}

TEST(MeshIo, AStopLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder.file("edit.json", "old");
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  expect_error([&] { write_file_atomically(path, "new", context); }, "core.cancelled", {});
  expect_error([&] { io::PendingFile(path, "new", io::Existing::replace, stop.get_token()); }, "core.cancelled",
               {});
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(MeshIo, AFileThatTakesTooMuchMemoryIsRefusedBeforeItIsRead) {
  const TemporaryFolder folder;
  const auto path = folder.file("in.ply", triangle_ply);
  Context context;
  context.memory = triangle_ply.size() - 1;
  expect_error([&] { read_mesh(path, context); }, "core.over_budget", {"in.ply", "0 MB are allowed"});
  context.memory = 100 * triangle_ply.size();
  EXPECT_EQ(read_mesh(path, context).vertex_count(), 3);
}

TEST(MeshIo, FilesWithoutPermissionAreNamed) {
  const TemporaryFolder folder;
  const OrdinaryUser user(folder);
  if (!user.can_be_denied()) GTEST_SKIP() << "this user may read everything";
  const auto path = folder.file("secret.ply", triangle_ply);
  fs::permissions(path, fs::perms::none);
  expect_error([&] { read_mesh(path); }, "io.no_permission",
               {"secret.ply", "Permission denied", "permissions"});
}

TEST(MeshIo, ASharedMeshComesBackFromBothFormats) {
  const TemporaryFolder folder;
  for (const char* name : {"out.ply", "out.obj"}) {
    const Mesh mesh = triangle();
    write_mesh(mesh, folder / name);
    const Mesh again = read_mesh(folder / name);
    EXPECT_TRUE(again.positions == mesh.positions);
    EXPECT_TRUE(again.faces == mesh.faces);
  }
  EXPECT_EQ(folder.entry_count(), 2u);
}

TEST(MeshIo, AnExistingFileIsReplacedOnlyIfAsked) {
  const TemporaryFolder folder;
  const auto path = folder.file("out.obj", "old");
  expect_error([&] { write_mesh(triangle(), path, {.overwrite = false}); }, "io.file_exists", {"out.obj"});
  EXPECT_EQ(read_file(path), "old");
  write_mesh(triangle(), path);
  EXPECT_EQ(read_file(path), triangle_obj);
  write_mesh(triangle(), folder / "new.obj", {.overwrite = false});
  EXPECT_EQ(read_file(folder / "new.obj"), triangle_obj);
  EXPECT_EQ(folder.entry_count(), 2u);
}

TEST(MeshIo, AReplacedFileKeepsItsPermissions) {
  const TemporaryFolder folder;
  const auto path = folder.file("out.obj", "old");
  for (const mode_t mode : {0600, 0664, 0755}) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    write_file_atomically(path, "new");
    struct stat status = {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, mode);
  }
}

TEST(MeshIo, ASymbolicLinkStaysALink) {
  const TemporaryFolder folder;
  const auto path = folder.file("real.obj", "old");
  fs::create_symlink("real.obj", folder / "link.obj");
  write_mesh(triangle(), folder / "link.obj");
  EXPECT_TRUE(fs::is_symlink(folder / "link.obj"));
  EXPECT_EQ(read_file(path), triangle_obj);
}

TEST(MeshIo, ALinkToNothingYetStaysALink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "deep");
  fs::create_symlink("deep/next.obj", folder / "first.obj");
  fs::create_symlink("real.obj", folder / "deep/next.obj");
  write_mesh(triangle(), folder / "first.obj");
  EXPECT_TRUE(fs::is_symlink(folder / "first.obj"));
  EXPECT_TRUE(fs::is_symlink(folder / "deep/next.obj"));
  EXPECT_EQ(read_file(folder / "deep/real.obj"), triangle_obj);

  fs::create_symlink("round.obj", folder / "round.obj");
  expect_error([&] { write_mesh(triangle(), folder / "round.obj"); }, "io.link_loop", {"round.obj", "circle"});
  expect_error([&] { read_mesh(folder / "round.obj"); }, "io.link_loop", {"round.obj", "circle"});
}

TEST(MeshIo, NamesThatNoFileCanHaveAreRefused) {
  expect_error([] { read_mesh(""); }, "io.no_file_name", {});
  expect_error([] { read_mesh(std::string("a.obj\0.ply", 10)); }, "io.name_with_nul", {});
  expect_error([] { write_mesh(triangle(), std::string("a\0.ply", 6)); }, "io.name_with_nul", {});
}

TEST(MeshIo, AFailedWriteLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder.file("out.ply", triangle_ply);
  Mesh mesh = read_mesh(path);
  mesh.positions(0, 0) = 1e300;  // too large for a float
  expect_error([&] { write_mesh(mesh, path); }, "io.value_does_not_fit", {"out.ply", "vertex 0"});
  EXPECT_EQ(read_file(path), triangle_ply);
  EXPECT_EQ(folder.entry_count(), 1u);

  expect_error([&] { write_mesh(triangle(), folder / "no/such/folder.ply"); }, "io.file_not_found",
               {"folder.ply"});
  fs::create_directory(folder / "folder.ply");
  expect_error([&] { write_mesh(triangle(), folder / "folder.ply"); }, "io.is_folder", {"folder.ply"});
  EXPECT_EQ(folder.entry_count(), 2u);
}

TEST(MeshIo, ADiskThatIsFullLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const auto path = folder.file("out.obj", "old");
  // A limit on the size of files stands in for a full disk.
  struct rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  struct rlimit tiny = before;
  tiny.rlim_cur = 10;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tiny), 0);
  std::string message;
  try {
    write_mesh(triangle(), path);
  } catch (const Error& error) {
    message = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, old_handler);
  EXPECT_NE(message.find("out.obj: cannot be written"), std::string::npos) << message;
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(MeshIo, AFolderOrFileWithoutPermissionIsNamed) {
  const TemporaryFolder folder;
  const OrdinaryUser user(folder);
  if (!user.can_be_denied()) GTEST_SKIP() << "this user may write everywhere";
  const auto path = folder.file("out.obj", "old");
  fs::permissions(path, fs::perms::owner_read);
  expect_error([&] { write_mesh(triangle(), path); }, "io.no_permission", {"out.obj", "Permission denied"});
  EXPECT_EQ(read_file(path), "old");
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  expect_error([&] { write_mesh(triangle(), folder / "new.obj"); }, "io.no_permission",
               {"new.obj", "Permission denied"});
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  expect_error([&] { write_mesh(triangle(), path); }, "io.no_permission", {"out.obj", "Permission denied"});
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(MeshIo, WritingAndReadingCanBeCancelled) {
  const TemporaryFolder folder;
  const auto path = folder.file("in.ply", triangle_ply);
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  expect_error([&] { read_mesh(path, context); }, "core.cancelled", {});
  expect_error([&] { write_mesh(triangle(), folder / "out.ply", {}, context); }, "core.cancelled", {});
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(MeshIo, AnyBytesCanBeReadAndWritten) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int k = 0; k < 100000; ++k) bytes += static_cast<char>(k * 31);
  write_file_atomically(folder / "bytes", bytes);
  EXPECT_TRUE(read_file(folder / "bytes") == bytes);
  write_file_atomically(folder / "bytes", "");
  EXPECT_EQ(read_file(folder / "bytes"), "");
}

}  // namespace
}  // namespace meshgraft
