#include <meshgraft/core/error.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <utility>
#include <vector>

#include "core/facts.h"

namespace meshgraft {

std::string_view to_string(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage: return "usage";
    case ErrorCode::input: return "input";
    case ErrorCode::unsolvable: return "unsolvable";
    case ErrorCode::io: return "io";
    case ErrorCode::memory: return "memory";
    case ErrorCode::cancelled: return "cancelled";
    case ErrorCode::internal: return "internal";
  }
  return "internal";
}

struct Error::Data {
  Fact fact;
  Location location;
  std::vector<Note> notes;
  std::string what;
};

namespace {

// Returns whether the text of a fact begins with a name that the user gave, such as a file's.
bool begins_with_name(const FactType& type) {
  if (!type.text.starts_with('{')) return false;
  const std::string_view field = type.text.substr(1, type.text.find_first_of(":}") - 1);
  return std::ranges::any_of(
      type.fields, [&](const FieldType& one) { return one.name == field && one.kind == FieldKind::text; });
}

// Adds a note after a full stop, and so with a capital letter.
std::string with_note(std::string_view sentence, const Note& note, std::string text) {
  if (!begins_with_name(note.type()) && !text.empty() && text.front() >= 'a' && text.front() <= 'z')
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return error_sentence({}, sentence, text);
}

std::string sentence_of(const Fact& fact, const Location& location, const std::vector<Note>& notes) {
  std::string sentence = error_sentence(location.text(), fact.text(), fact.remedy());
  for (const Note& note : notes) sentence = with_note(sentence, note, note.text());
  return sentence;
}

}  // namespace

Error::Error(Fact fact, Location location) {
  std::string what = sentence_of(fact, location, {});
  data_ = std::make_shared<const Data>(Data{std::move(fact), std::move(location), {}, std::move(what)});
}

const char* Error::what() const noexcept { return data_->what.c_str(); }

ErrorCode Error::code() const noexcept { return data_->fact.type().code.value_or(ErrorCode::internal); }

const Fact& Error::fact() const noexcept { return data_->fact; }

const Location& Error::location() const noexcept { return data_->location; }

std::span<const Note> Error::notes() const noexcept { return data_->notes; }

Error Error::at(Location location) const {
  Data data = *data_;
  data.location = std::move(location);
  data.what = sentence_of(data.fact, data.location, data.notes);
  Error error = *this;
  error.data_ = std::make_shared<const Data>(std::move(data));
  return error;
}

Error Error::within(const Location& outer) const { return at(outer / location()); }

Error Error::with(Note note) const {
  Data data = *data_;
  data.notes.push_back(std::move(note));
  data.what = sentence_of(data.fact, data.location, data.notes);
  Error error = *this;
  error.data_ = std::make_shared<const Data>(std::move(data));
  return error;
}

std::string error_sentence(std::string_view location, std::string_view problem, std::string_view remedy) {
  std::string sentence(location);
  if (!location.empty()) sentence += ": ";
  sentence += problem;
  if (!remedy.empty()) sentence += sentence.ends_with('.') ? " " : ". ";
  return sentence += remedy;
}

std::string sentence(const Error& error, const Wording& wording) {
  const FactText text = wording(error.fact());
  std::string whole = error_sentence(error.location().text(), text.statement, text.remedy);
  for (const Note& note : error.notes()) whole = with_note(whole, note, sentence(note, wording));
  return whole;
}

std::string sentence(const Note& note, const Wording& wording) {
  const FactText text = wording(note);
  return error_sentence({}, text.statement, text.remedy);
}

Error current_error() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return Error(facts::core::OutOfMemory{});
  } catch (const std::filesystem::filesystem_error& error) {
    return Error(facts::core::FileSystem{.reason = error.code().message()}, error.path1());
  } catch (const std::exception& error) {
    return Error(facts::core::Bug{.what = error.what()});
  }
}

}  // namespace meshgraft
