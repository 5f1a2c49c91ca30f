#include "capture/camera/camera_directory.h"

#include <arv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace drupe {
namespace {

/// Aravis's own GigE Vision camera: the real protocol on loopback.
class FakeGigECamera {
 public:
  explicit FakeGigECamera(const char* serial) : camera_(arv_gv_fake_camera_new("127.0.0.1", serial)) {}
  ~FakeGigECamera() { g_object_unref(camera_); }
  FakeGigECamera(const FakeGigECamera&) = delete;
  FakeGigECamera& operator=(const FakeGigECamera&) = delete;

  bool is_running() const { return arv_gv_fake_camera_is_running(camera_); }

 private:
  ArvGvFakeCamera* camera_;
};

const CameraInfo* Find(const std::vector<CameraInfo>& cameras, const std::string& serial) {
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [&](const CameraInfo& camera) { return camera.serial == serial; });
  return found == cameras.end() ? nullptr : &*found;
}

TEST(CameraDirectoryTest, FindsACameraThatSpeaksGigEVision) {
  const FakeGigECamera fake("DRUPE1");
  ASSERT_TRUE(fake.is_running());
  CameraDirectory directory;
  const auto cameras = directory.List();
  ASSERT_TRUE(cameras.ok()) << cameras.status().ToString();
  const CameraInfo* camera = Find(*cameras, "DRUPE1");
  ASSERT_NE(camera, nullptr) << cameras->size() << " other cameras";
  EXPECT_EQ(camera->id, "Aravis-Fake-DRUPE1");
  EXPECT_EQ(camera->vendor, "Aravis");
  EXPECT_EQ(camera->address, "127.0.0.1");
  EXPECT_EQ(camera->protocol, "GigEVision");
  EXPECT_FALSE(camera->model.empty());
}

TEST(CameraDirectoryTest, AnswersWithoutThatCamera) {
  CameraDirectory directory({.max_age = std::chrono::milliseconds(0)});
  const auto cameras = directory.List();
  ASSERT_TRUE(cameras.ok());
  EXPECT_EQ(Find(*cameras, "DRUPE1"), nullptr);
}

TEST(CameraDirectoryTest, ManyAskersShareOneSearch) {
  CameraDirectory directory;
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::thread> threads;
  std::atomic<int> answered = 0;
  for (int i = 0; i < 8; ++i) threads.emplace_back([&] { answered += directory.List().ok() ? 1 : 0; });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answered, 8);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(CameraDirectoryTest, DoesNotWaitBeyondItsPatience) {
  CameraDirectory directory({.patience = std::chrono::milliseconds(1)});
  const auto first = directory.List();
  ASSERT_FALSE(first.ok());
  EXPECT_EQ(first.status().code(), "camera_search_slow");
  EXPECT_EQ(first.status().kind(), StatusKind::kUnavailable);
  bool answered = false;  // the search goes on meanwhile
  for (int i = 0; i < 100 && !answered; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    answered = directory.List().ok();
  }
  EXPECT_TRUE(answered);
}

}  // namespace
}  // namespace drupe
