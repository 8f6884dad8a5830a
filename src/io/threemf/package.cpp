#include "package.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#include <zip.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/sparse_checks.h"
#include "threemf/facts.h"

namespace meshgraft::io {

namespace {

std::string message_of(zip_error_t& error) {
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

/// An archive in memory. Closing it writes the changes to the same source.
class Archive {
 public:
  Archive(std::string_view bytes, int flags, const Context& context) : context_(context) {
    zip_error_t error;
    zip_error_init(&error);
    // libzip owns and frees this copy. When an archive is changed, its source frees the given bytes in any
    // case (libzip 1.7).
    auto* copy = bytes.empty() ? nullptr : static_cast<char*>(std::malloc(bytes.size()));
    if (copy == nullptr && !bytes.empty()) throw std::bad_alloc();
    std::copy(bytes.begin(), bytes.end(), copy);
    source_ = zip_source_buffer_create(copy, bytes.size(), 1, &error);
    if (source_ == nullptr) std::free(copy);
    if (source_ != nullptr) archive_ = zip_open_from_source(source_, flags, &error);
    if (archive_ == nullptr) {
      if (source_ != nullptr) zip_source_free(source_);
      throw Error(facts::threemf::NotZip{.reason = message_of(error)});
    }
    zip_source_keep(source_);
    zip_register_cancel_callback_with_state(archive_, &is_stopped, nullptr, const_cast<Context*>(&context_));
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
    zip_source_free(source_);
  }

  zip_t* get() const { return archive_; }

  std::string close() {
    if (zip_close(archive_) != 0) {
      context_.throw_if_stopped();
      throw Error(facts::threemf::WriteFailed{.reason = zip_strerror(archive_)});
    }
    archive_ = nullptr;
    zip_stat_t status;
    std::string bytes;
    if (zip_source_open(source_) != 0 || zip_source_stat(source_, &status) != 0)
      throw Error(facts::core::Bug{.what = "the written package cannot be read"});
    bytes.resize(status.size);
    const zip_int64_t got = zip_source_read(source_, bytes.data(), bytes.size());
    zip_source_close(source_);
    if (got != static_cast<zip_int64_t>(bytes.size()))
      throw Error(facts::core::Bug{.what = "the written package cannot be read whole"});
    return bytes;
  }

 private:
  // Asked by libzip while it writes. A result other than 0 makes `zip_close` fail.
  static int is_stopped(zip_t*, void* context) {
    return is_stop_requested(*static_cast<const Context*>(context)) ? 1 : 0;
  }

  const Context& context_;
  zip_source_t* source_ = nullptr;
  zip_t* archive_ = nullptr;
};

std::string ascii_lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

// Refuses files that unpack to an implausible size. A text of numbers shrinks to about a tenth.
void require_plausible(const zip_stat_t& entry, const std::string& location) {
  constexpr zip_uint64_t small = zip_uint64_t{64} << 20;
  constexpr zip_uint64_t largest_ratio = 200;
  if (entry.size > small && entry.size / largest_ratio > entry.comp_size)
    throw Error(facts::threemf::PartTooLarge{.bytes = entry.size, .ratio = largest_ratio},
                Location::file(location));
}

std::string read_entry(zip_t* archive, const zip_stat_t& entry, const std::string& location,
                       const Context& context) {
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(archive, entry.index, 0),
                                                               &zip_fclose);
  if (!file)
    throw Error(facts::threemf::CannotUnpack{.reason = zip_strerror(archive)}, Location::file(location));
  // Reads by pieces, because the size in the archive may be wrong.
  constexpr std::size_t piece = std::size_t{1} << 20;
  std::string content;
  content.reserve(entry.size + piece);
  for (;;) {
    context.throw_if_stopped();
    const std::size_t size = content.size();
    content.resize(size + piece);
    const zip_int64_t got = zip_fread(file.get(), content.data() + size, piece);
    content.resize(size + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
    if (got < 0 || content.size() > entry.size)
      throw Error(facts::threemf::DataDamaged{}, Location::file(location));
    if (got == 0) return content;
  }
}

zip_stat_t stat_of(zip_t* archive, zip_uint64_t index) {
  zip_stat_t entry;
  zip_stat_init(&entry);
  constexpr zip_uint64_t needed = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_INDEX;
  if (zip_stat_index(archive, index, 0, &entry) != 0 || (entry.valid & needed) != needed)
    throw Error(facts::threemf::ContentsDamaged{});
  return entry;
}

}  // namespace

std::vector<PackagePart> model_parts(std::string_view package, const std::string& name, MemoryBudget& budget,
                                     const Context& context) try {
  budget.charge(package.size());
  const Archive archive(package, ZIP_RDONLY, context);
  const auto count = static_cast<zip_uint64_t>(zip_get_num_entries(archive.get(), 0));
  std::vector<zip_stat_t> models;
  std::uint64_t text = 0;
  for (zip_uint64_t i = 0; i < count; ++i) {
    const zip_stat_t entry = stat_of(archive.get(), i);
    require_plausible(entry, entry.name);
    budget.charge(entry.size);
    if (!ascii_lower_case(entry.name).ends_with(".model")) continue;
    models.push_back(entry);
    text += entry.size;
  }
  budget.require(text);  // what the text becomes takes more than itself
  std::vector<PackagePart> parts;
  for (const zip_stat_t& entry : models)
    parts.push_back({entry.name, read_entry(archive.get(), entry, entry.name, context)});
  if (parts.empty()) throw Error(facts::threemf::NoModel{});
  budget.release(package.size());
  return parts;
} catch (const Error& error) {
  throw error.code() == ErrorCode::cancelled ? error : error.within(Location::file(name));
}

std::string with_parts(std::string_view package, const std::vector<PackagePart>& parts,
                       const Context& context) {
  Archive archive(package, 0, context);
  for (const PackagePart& part : parts) {
    const zip_int64_t index = zip_name_locate(archive.get(), part.name.c_str(), 0);
    zip_stat_t old;
    zip_stat_init(&old);
    zip_source_t* source =
        index < 0 ? nullptr : zip_source_buffer(archive.get(), part.content.data(), part.content.size(), 0);
    if (source == nullptr || zip_stat_index(archive.get(), static_cast<zip_uint64_t>(index), 0, &old) != 0 ||
        zip_file_replace(archive.get(), static_cast<zip_uint64_t>(index), source, 0) != 0) {
      if (source != nullptr) zip_source_free(source);
      throw Error(facts::core::Bug{.what = "the part " + part.name + " cannot be replaced"});
    }
    zip_set_file_compression(archive.get(), static_cast<zip_uint64_t>(index),
                             old.comp_method == ZIP_CM_STORE ? ZIP_CM_STORE : ZIP_CM_DEFLATE, 0);
    zip_file_set_mtime(archive.get(), static_cast<zip_uint64_t>(index), old.mtime, 0);
  }
  return archive.close();
}

}  // namespace meshgraft::io
