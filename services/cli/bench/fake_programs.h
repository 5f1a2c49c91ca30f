#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace drupe {

/// For tests: a directory of programs with nothing else on PATH while it lives, and room for what they read and write.
class FakePrograms {
 public:
  FakePrograms()
      : directory_(std::filesystem::path(testing::TempDir()) /
                   (std::string("fake_programs_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
                    std::to_string(::getpid()))) {
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_ / "bin");
    std::filesystem::create_directories(directory_ / "out");
    const char* path = std::getenv("PATH");
    old_path_ = path == nullptr ? "" : path;
    setenv("PATH", (directory_ / "bin").c_str(), 1);
  }
  ~FakePrograms() {
    setenv("PATH", old_path_.c_str(), 1);
    std::filesystem::remove_all(directory_);
  }
  FakePrograms(const FakePrograms&) = delete;
  FakePrograms& operator=(const FakePrograms&) = delete;

  /// A program that adds its name and arguments to the file `arguments` and runs `body` (sh).
  void Add(const std::string& name, const std::string& body) const {
    const std::filesystem::path program = directory_ / "bin" / name;
    std::ofstream(program) << "#!/bin/sh\necho " << name << " \"$@\" >> " << Path("arguments") << "\n" << body << "\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  }

  /// Of a file or folder here; `out` is a folder for the programs' results.
  std::string Path(const std::string& name) const { return (directory_ / name).string(); }
  void Write(const std::string& name, const std::string& content) const { std::ofstream(Path(name)) << content; }
  std::string Read(const std::string& name) const {
    std::ifstream file(Path(name));
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::filesystem::path directory_;
  std::string old_path_;
};

}  // namespace drupe
