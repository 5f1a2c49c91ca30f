#include "service/remote_object_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "base/digest.h"
#include "base/ids.h"
#include "http/content.h"
#include "http/server.h"
#include "service/object_routes.h"
#include "service/object_source.h"
#include "store/object_roots.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// A source that breaks off once, in the middle.
class BreakingSource : public ByteSource {
 public:
  BreakingSource(std::unique_ptr<ObjectReader> reader, std::atomic<int>& breaks_left)
      : source_(std::move(reader)), breaks_left_(breaks_left) {}
  std::uint64_t size() const override { return source_.size(); }
  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<char> buffer) override {
    if (offset > size() / 4 && breaks_left_.fetch_sub(1) > 0) return Internal("broken", "the line is cut");
    return source_.ReadAt(offset, buffer);
  }

 private:
  ObjectSource source_;
  std::atomic<int>& breaks_left_;
};

/// A machine with a store on its disk that it serves, and another one with a cache.
class RemoteObjectStoreTest : public testing::Test {
 protected:
  RemoteObjectStoreTest() {
    AddObjectRoutes(server_.router(), *disk_);
    EXPECT_TRUE(server_.Bind().ok());
    listener_ = std::thread([this] { (void)server_.Serve(); });
    remote_ = OpenRemote();
  }
  ~RemoteObjectStoreTest() override {
    server_.Stop();
    listener_.join();
    fs::remove_all(directory_);
  }

  static RemoteStoreOptions Options() {
    return {.cache_bytes = 1000, .min_free_bytes = 0, .patience = milliseconds(20'000), .first_pause = milliseconds(5)};
  }
  std::unique_ptr<RemoteObjectStore> OpenRemote() { return OpenRemote(Options()); }
  std::unique_ptr<RemoteObjectStore> OpenRemote(const RemoteStoreOptions& options) {
    const std::string url = "http://127.0.0.1:" + std::to_string(server_.port());
    return std::move(RemoteObjectStore::Open(url, directory_ / "cache", options).value());
  }
  std::uint64_t CacheBytes() const {
    std::uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(directory_ / "cache")) {
      if (entry.is_regular_file() && IsSha256Hex(entry.path().filename().string())) bytes += entry.file_size();
    }
    return bytes;
  }

  const fs::path directory_ = [] {
    fs::path path = fs::temp_directory_path() / NewId("remote");
    fs::create_directories(path);
    return path;
  }();
  std::unique_ptr<DiskObjectStore> disk_ = DiskObjectStore::Open(directory_ / "disk", {.min_free_bytes = 0}).value();
  Server server_{{}, nullptr};
  std::thread listener_;
  std::unique_ptr<RemoteObjectStore> remote_;
};

TEST_F(RemoteObjectStoreTest, WritesThereAndReadsFromThereOrFromItsCopy) {
  const ObjectInfo put = remote_->Put("plum").value();
  EXPECT_EQ(put, (ObjectInfo{Sha256Hex("plum"), 4}));
  EXPECT_EQ(disk_->Get(put.sha256).value(), "plum");
  const std::string there = disk_->Put("pear").value().sha256;
  EXPECT_TRUE(remote_->Contains(there));
  EXPECT_EQ(remote_->Size(there).value(), 4u);
  EXPECT_EQ(remote_->Get(there).value(), "pear");
  ASSERT_TRUE(disk_->Remove(there).ok());
  std::string read(2, '\0');
  const auto reader = remote_->OpenObject(there);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ((*reader)->ReadAt(1, std::as_writable_bytes(std::span(read))).value(), 2u);
  EXPECT_EQ(read, "ea") << "from the copy, since it is gone there";
  EXPECT_EQ(remote_->Put("").value().bytes, 0u);
  EXPECT_EQ(disk_->Get(Sha256Hex("")).value(), "");
  EXPECT_TRUE(remote_->CheckWritable(1).ok());
  ASSERT_TRUE(remote_->Remove(put.sha256).ok());
  EXPECT_FALSE(disk_->Contains(put.sha256));
}

TEST_F(RemoteObjectStoreTest, TellsWhatIsWrongInTheWordsOfTheInterface) {
  EXPECT_EQ(remote_->Get(Sha256Hex("none")).status().code(), "object_not_found");
  EXPECT_EQ(remote_->Get("../etc/passwd").status().code(), "invalid_digest");
  EXPECT_FALSE(remote_->Contains(Sha256Hex("none")));
  const std::string big = disk_->Put("12345").value().sha256;
  EXPECT_EQ(remote_->Get(big, 4).status().code(), "object_too_large");
  auto options = Options();
  options.patience = milliseconds(50);
  const auto away = std::move(RemoteObjectStore::Open("http://127.0.0.1:1", directory_ / "other", options).value());
  EXPECT_EQ(away->Put("x").status().code(), "unreachable");
}

TEST_F(RemoteObjectStoreTest, SendsALongObjectInPiecesAndGoesOnWhereItStopped) {
  auto options = Options();
  options.piece_bytes = 10;
  options.cache_bytes = 1 << 20;
  remote_ = OpenRemote(options);
  std::string bytes;
  for (int i = 0; i < 1000; ++i) bytes += std::to_string(i);
  const std::string sha256 = Sha256Hex(bytes);
  {
    auto upload = disk_->ResumeUpload(sha256, 0, bytes.size()).value();
    ASSERT_TRUE(upload.Append(std::as_bytes(std::span(bytes).first(2000))).ok());
  }
  ASSERT_TRUE(remote_->Put(bytes).ok());
  EXPECT_EQ(disk_->Get(sha256).value(), bytes);
}

TEST_F(RemoteObjectStoreTest, ADamagedUploadIsDroppedAndSentAnew) {
  const std::string plums(100, 'p');
  {
    auto upload = disk_->ResumeUpload(Sha256Hex(plums), 0, plums.size()).value();
    ASSERT_TRUE(upload.Append(std::as_bytes(std::span("xxxx", 4))).ok());
  }
  ASSERT_TRUE(remote_->Put(plums).ok());
  EXPECT_EQ(disk_->Get(Sha256Hex(plums)).value(), plums);
}

TEST_F(RemoteObjectStoreTest, CacheStaysWithinItsBoundAndDropsWhatWasUsedLongestAgo) {
  std::vector<std::string> digests;
  for (const char c : {'a', 'b', 'c'}) digests.push_back(disk_->Put(std::string(300, c)).value().sha256);
  for (const std::string& digest : digests) ASSERT_TRUE(remote_->Get(digest).ok());
  const std::string last = disk_->Put(std::string(300, 'd')).value().sha256;
  std::this_thread::sleep_for(milliseconds(5));  // the clock of the cache ticks in milliseconds
  ASSERT_TRUE(remote_->Get(digests[0]).ok());
  ASSERT_TRUE(remote_->Get(last).ok());
  EXPECT_EQ(CacheBytes(), 900u);
  const auto in_cache = [&](const std::string& digest) {
    return fs::exists(directory_ / "cache" / digest.substr(0, 2) / digest);
  };
  EXPECT_TRUE(in_cache(digests[0]));
  EXPECT_FALSE(in_cache(digests[1])) << "used longest ago";
  EXPECT_TRUE(in_cache(last));
  EXPECT_EQ(remote_->Get(digests[1]).value(), std::string(300, 'b'));
}

TEST_F(RemoteObjectStoreTest, ADamagedCopyIsFetchedAnew) {
  const std::string sha256 = remote_->Put("plum").value().sha256;
  std::ofstream(directory_ / "cache" / sha256.substr(0, 2) / sha256) << "pear";
  EXPECT_EQ(remote_->Get(sha256).value(), "plum");
}

TEST_F(RemoteObjectStoreTest, SaysWhatItsServiceRefersTo) {
  const std::string digest = Sha256Hex("plum");
  ASSERT_TRUE(remote_->KeepRoots("analysis", {digest}).ok());
  const ObjectRoots roots = ReadRoots(directory_ / "disk").value();
  EXPECT_EQ(roots.digests, std::set<std::string>{digest});
  EXPECT_EQ(roots.owners, std::set<std::string>{"analysis"});
  EXPECT_GT(roots.oldest_ns, 0);
  EXPECT_EQ(remote_->KeepRoots("../x", {}).kind(), StatusKind::kNotFound);
}

TEST(RemoteObjectStoreFault, GoesOnWhereATornConnectionStopped) {
  const fs::path directory = fs::temp_directory_path() / NewId("torn");
  fs::create_directories(directory);
  {
    const auto disk = DiskObjectStore::Open(directory / "disk", {.min_free_bytes = 0}).value();
    const std::string bytes(3'000'000, 'p');
    const std::string sha256 = disk->Put(bytes).value().sha256;
    const std::string other = disk->Put(std::string(3'000'000, 'q')).value().sha256;
    std::atomic<int> breaks_left{2};
    std::atomic<int> ranges{0};
    Server server({}, nullptr);
    server.router().Add("GET", "/objects/{sha256}", {}, [&](const Request& request, Response& response) {
      if (!request.Header("Range").empty()) ++ranges;
      const bool lie = request.Capture("sha256") == other;
      auto source = std::make_shared<BreakingSource>(std::move(disk->OpenObject(sha256).value()), breaks_left);
      SendContent(request, source, "application/octet-stream", lie ? other : sha256, response);
    });
    ASSERT_TRUE(server.Bind().ok());
    std::thread listener([&] { (void)server.Serve(); });
    const RemoteStoreOptions options{.min_free_bytes = 0, .first_pause = milliseconds(5)};
    const auto remote = std::move(
        RemoteObjectStore::Open("http://127.0.0.1:" + std::to_string(server.port()), directory / "cache", options)
            .value());
    EXPECT_EQ(remote->Get(sha256).value(), bytes);
    EXPECT_EQ(ranges, 2) << "each time only the rest was asked for";
    EXPECT_EQ(remote->Get(other).status().code(), "object_damaged") << "bytes of another digest came";
    server.Stop();
    listener.join();
  }
  fs::remove_all(directory);
}

}  // namespace
}  // namespace drupe
