#include "base/ids.h"

#include <algorithm>
#include <random>

namespace drupe {

namespace {

bool IsLowerAlnum(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

bool IsNameCharacter(char c) {
  return IsLowerAlnum(c) || (c >= 'A' && c <= 'Z') || c == '.' || c == '_' || c == '-';
}

}  // namespace

std::string NewId(std::string_view prefix) {
  constexpr std::string_view kAlphabet = "abcdefghijklmnopqrstuvwxyz0123456789";
  constexpr int kLength = 20;
  thread_local std::random_device device;
  std::uniform_int_distribution<std::size_t> pick(0, kAlphabet.size() - 1);
  std::string id(prefix);
  id.push_back('_');
  for (int i = 0; i < kLength; ++i) id.push_back(kAlphabet[pick(device)]);
  return id;
}

bool IsId(std::string_view text, std::string_view prefix) {
  if (text.size() < prefix.size() + 2 || text.size() > prefix.size() + 41) return false;
  if (text.substr(0, prefix.size()) != prefix || text[prefix.size()] != '_') return false;
  const std::string_view rest = text.substr(prefix.size() + 1);
  return std::all_of(rest.begin(), rest.end(), IsLowerAlnum);
}

Status CheckImageName(std::string_view name) {
  const bool valid = !name.empty() && name.size() <= 128 && name.front() != '.' &&
                     std::all_of(name.begin(), name.end(), IsNameCharacter);
  if (valid) return Status::Ok();
  return InvalidArgument("invalid_name",
                         "an image name has 1 to 128 characters of [A-Za-z0-9._-] and does not start with a dot",
                         "name");
}

}  // namespace drupe
