#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "base/clock.h"
#include "base/digest.h"
#include "base/files.h"
#include "base/ids.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/status.h"

namespace drupe {
namespace {

TEST(Digest, MatchesPublishedVectors) {
  EXPECT_EQ(Sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Digest, OnlyLowerCaseHexNamesAnObject) {
  EXPECT_TRUE(IsSha256Hex(Sha256Hex("x")));
  EXPECT_FALSE(IsSha256Hex(std::string(64, 'A')));
  EXPECT_FALSE(IsSha256Hex("../../etc/passwd"));
  EXPECT_FALSE(IsSha256Hex(std::string(63, 'a')));
}

TEST(Json, DepthIsLimitedBeforeAnythingDeepIsBuilt) {
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  const auto result = ParseJson(deep);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), "json_too_deep");
  EXPECT_TRUE(ParseJson("[[[[1]]]]", {.max_depth = 4}).ok());
  EXPECT_FALSE(ParseJson("[[[[[1]]]]]", {.max_depth = 4}).ok());
}

TEST(Json, BadTextIsRefusedWithItsPlace) {
  const auto result = ParseJson("{\"a\": }");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), "invalid_json");
  EXPECT_NE(result.status().message().find("byte 7"), std::string::npos) << result.status().message();
}

TEST(Json, BytesOutsideUtf8AreReplaced) { EXPECT_NO_THROW(DumpJson(Json(std::string("\xff\xfe")))); }

TEST(Ids, NewIdsAreDistinctAndValid) {
  const std::string a = NewId("rec");
  EXPECT_NE(a, NewId("rec"));
  EXPECT_TRUE(IsId(a, "rec"));
  EXPECT_FALSE(IsId(a, "img"));
  EXPECT_FALSE(IsId("rec_../x", "rec"));
  EXPECT_FALSE(IsId("rec_", "rec"));
}

TEST(Ids, ImageNamesCannotLeaveADirectory) {
  EXPECT_TRUE(CheckImageName("00.jpg").ok());
  for (const char* bad : {"", ".", "..", ".hidden", "a/b.jpg", "..\\x", "a b", "\xc3\xa9.jpg"}) {
    EXPECT_FALSE(CheckImageName(bad).ok()) << bad;
  }
  EXPECT_FALSE(CheckImageName(std::string(129, 'a')).ok());
}

TEST(Parallel, EveryIndexOnceForAnyThreadCount) {
  for (int threads : {1, 2, 5}) {
    std::vector<int> counts(1000, 0);
    RunContext context;
    context.threads = threads;
    ASSERT_TRUE(ParallelFor(context, counts.size(), [&](std::size_t i) { ++counts[i]; }).ok());
    EXPECT_EQ(counts, std::vector<int>(1000, 1));
  }
}

TEST(Parallel, AnExceptionComesBackAsStatus) {
  RunContext context;
  context.threads = 3;
  const Status status = ParallelFor(context, 10, [](std::size_t i) {
    if (i == 4) throw std::runtime_error("four");
  });
  EXPECT_EQ(status.kind(), StatusKind::kInternal);
  EXPECT_EQ(status.message(), "four");
}

TEST(Parallel, CancelStopsTheWork) {
  std::atomic<int> done{0};
  RunContext context;
  context.threads = 2;
  context.cancelled = [&] { return done >= 5; };
  EXPECT_EQ(ParallelFor(context, 100000, [&](std::size_t) { ++done; }).kind(), StatusKind::kCancelled);
  EXPECT_LT(done, 100);
}

TEST(Files, AtomicWriteReplacesAndLeavesNoTemporary) {
  const auto directory = std::filesystem::temp_directory_path() / NewId("test");
  std::filesystem::create_directory(directory);
  ASSERT_TRUE(WriteFileAtomically(directory / "a", "one").ok());
  ASSERT_TRUE(WriteFileAtomically(directory / "a", "two").ok());
  EXPECT_EQ(*ReadFile(directory / "a"), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory), {}), 1);
  EXPECT_EQ(ReadFile(directory / "b").status().code(), "file_not_found");
  EXPECT_EQ(ReadFile(directory / "a", 2).status().code(), "file_too_large");
  std::filesystem::remove_all(directory);
}

TEST(Clock, FormatsUtc) { EXPECT_EQ(FormatUtc(1700000000123), "2023-11-14T22:13:20.123Z"); }

}  // namespace
}  // namespace drupe
