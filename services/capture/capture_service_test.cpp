#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "base/files.h"
#include "base/ids.h"
#include "capture/calibration_job.h"
#include "capture/routes.h"
#include "capture/store_fixture.h"
#include "http/request.h"
#include "http/response.h"
#include "http/text_body.h"
#include "jobs/sql/sql_job_store.h"

namespace drupe {
namespace {

std::string Part(const std::string& disposition, const std::string& content) {
  return "--B\r\nContent-Disposition: form-data; " + disposition + "\r\n\r\n" + content + "\r\n";
}
std::string ImagePart(const std::string& name, const std::string& content) {
  return Part("name=\"images\"; filename=\"" + name + "\"", content);
}
std::string PatternPart(
    const std::string& json = R"({"pattern": "checkerboard", "inner_corners": [11, 8], "square_mm": 6})") {
  return Part("name=\"pattern\"", json);
}

std::string SamplePicture(int number) {
  const auto bytes = ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/calibration/0" + std::to_string(number) + ".jpg");
  EXPECT_TRUE(bytes.ok());
  return bytes.ok() ? *bytes : "";
}

/// The service's routes over stores in a directory of their own.
class CaptureServiceTest : public StoreTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(StoreTest::SetUp());
    auto jobs = OpenJobStore(*database_);
    ASSERT_TRUE(jobs.ok());
    jobs_ = std::move(*jobs);
    calibrations_ = Open<CalibrationStore>();
    AddCaptureRoutes(router_, {*objects_, *jobs_, cameras_, *calibrations_, Limits{}, "", "http://127.0.0.1:8082"});
  }

  Response Call(const std::string& method, const std::string& path, const std::string& body = "",
                const std::string& key = "") {
    Request request;
    request.method = method, request.path = path;
    TextBody reader(body);
    request.body = &reader;
    request.headers.emplace("Content-Type", "multipart/form-data; boundary=B");
    if (!key.empty()) request.headers.emplace("Idempotency-Key", key);
    std::string allowed;
    Response response;
    const auto route = router_.Find(method, path, request, allowed);
    if (!route.ok()) {
      response.SetError(route.status());
    } else {
      (*route)->handler(request, response);
    }
    return response;
  }
  Json CallJson(const std::string& path) {
    const auto json = ParseJson(Call("GET", path).body);
    EXPECT_TRUE(json.ok());
    return json.ok() ? *json : Json();
  }
  std::string PostError(const std::string& parts, int status) {
    const Response response = Call("POST", "/calibrations", parts + "--B--\r\n");
    EXPECT_EQ(response.status, status) << response.body;
    const auto json = ParseJson(response.body);
    return json.ok() && json->contains("error") ? (*json)["error"].value("code", "") : "no error";
  }
  /// Runs the jobs until `id` has ended.
  void Work(const std::string& id) {
    JobRunner runner(*jobs_, {});
    runner.Handle(kCalibrateKind, CalibrationJob(*objects_, *calibrations_, Limits{}), CalibrationStages());
    ASSERT_TRUE(runner.Start().ok());
    for (int i = 0; i < 600 && !IsTerminal(jobs_->Get(id)->state); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  std::unique_ptr<JobStore> jobs_;
  std::unique_ptr<CalibrationStore> calibrations_;
  CameraDirectory cameras_;
  Router router_;
};

TEST_F(CaptureServiceTest, CalibratesFromAnUpload) {
  std::string form = PatternPart() + Part("name=\"camera\"", R"({"serial": "S1", "lens": "25 mm"})");
  form += ImagePart("broken.jpg", "\xFF\xD8\xFF\xE0 nothing");
  for (int i = 0; i < 5; ++i) form += ImagePart(std::to_string(i) + ".jpg", SamplePicture(i));
  form += "--B--\r\n";
  const Response accepted = Call("POST", "/calibrations", form, "key-1");
  ASSERT_EQ(accepted.status, 202) << accepted.body;
  const Json submitted = *ParseJson(accepted.body);
  const std::string id = submitted["id"];
  EXPECT_TRUE(IsId(id, "cal"));
  EXPECT_EQ(accepted.headers.back().second, "/calibrations/" + id);
  EXPECT_EQ(submitted["status"], "queued");
  EXPECT_EQ(Call("GET", "/calibrations/" + id + "/calibration.json").status, 409);
  EXPECT_EQ((*ParseJson(Call("POST", "/calibrations", form, "key-1").body))["id"], id);

  Work(id);
  const Json done = CallJson("/calibrations/" + id);
  ASSERT_EQ(done["status"], "succeeded") << done.dump(1);
  EXPECT_EQ(done["refused_images"][0]["name"], "broken.jpg");
  EXPECT_EQ(done["refused_images"][0]["code"], "bad_image");
  EXPECT_EQ(done["result"]["pictures"].size(), 5U);
  EXPECT_NEAR(done["result"]["calibration"]["K"][0][0].get<double>() / 1886.2034, 1, 1e-3);
  const std::string own_id = done["calibration_id"];
  EXPECT_EQ(own_id, CalibrationId(done["result"]["calibration"], {"S1", "25 mm"}));
  EXPECT_EQ(CallJson("/calibrations/" + own_id)["id"], id);
  EXPECT_EQ(done["camera"]["serial"], "S1");
  EXPECT_EQ(Call("GET", "/calibrations/" + own_id + "/coverage.png").content_type, "image/png");
  EXPECT_EQ(Call("GET", "/calibrations/" + own_id + "/calibration.json").status, 200);
  const Response file = Call("GET", "/calibrations/" + id + "/calibration.json");
  EXPECT_EQ(file.status, 200);
  ASSERT_NE(file.source, nullptr);
  const Json list = CallJson("/calibrations");
  EXPECT_EQ(list["calibrations"].size(), 1U);
  EXPECT_EQ(list["calibrations"][0]["verdict"], done["result"]["verdict"]);
}

TEST_F(CaptureServiceTest, AFailedCalibrationSaysWhy) {
  std::string form = PatternPart(R"({"pattern": "checkerboard", "inner_corners": [5, 17], "square_mm": 6})");
  for (int i = 0; i < 3; ++i) form += ImagePart(std::to_string(i) + ".jpg", SamplePicture(i));
  const Response accepted = Call("POST", "/calibrations", form + "--B--\r\n");
  ASSERT_EQ(accepted.status, 202);
  const std::string id = (*ParseJson(accepted.body))["id"];
  Work(id);
  const Json failed = CallJson("/calibrations/" + id);
  EXPECT_EQ(failed["status"], "failed");
  EXPECT_EQ(failed["error"]["code"], "too_few_pattern_pictures");
}

TEST_F(CaptureServiceTest, RefusesBadForms) {
  const std::string picture = SamplePicture(0);
  const std::string three = ImagePart("a.jpg", picture) + ImagePart("b.jpg", picture) + ImagePart("c.jpg", picture);
  EXPECT_EQ(PostError(three, 400), "missing_part");
  EXPECT_EQ(PostError(PatternPart(), 400), "too_few_images");
  EXPECT_EQ(PostError(PatternPart() + ImagePart("a.jpg", picture), 400), "too_few_images");
  EXPECT_EQ(PostError(three + PatternPart() + PatternPart(), 400), "duplicate_part");
  EXPECT_EQ(PostError(three + ImagePart("a.jpg", picture), 400), "duplicate_name");
  EXPECT_EQ(PostError(ImagePart("../../etc/passwd", picture), 400), "invalid_name");
  EXPECT_EQ(PostError(three + PatternPart("{\"pattern\": \"charuco\"}"), 400), "invalid_pattern");
  EXPECT_EQ(PostError(three + PatternPart() + Part("name=\"camera\"", "{\"serial\": 3}"), 400), "invalid_option");
  EXPECT_EQ(PostError(three + PatternPart("{"), 400), "invalid_json");
  EXPECT_EQ(PostError(three + PatternPart(std::string(5000, ' ')), 413), "json_too_large");
  EXPECT_EQ(PostError(Part("name=\"board\"", "{}"), 400), "unknown_part");
  EXPECT_EQ(PostError(PatternPart() + ImagePart("a.gif", "GIF89a") + ImagePart("b.jpg", picture), 415),
            "unsupported_image");
}

TEST_F(CaptureServiceTest, ListsCamerasAndKnowsNothingElse) {
  EXPECT_TRUE(CallJson("/cameras")["cameras"].is_array());
  EXPECT_EQ(Call("POST", "/scans").status, 404);
  EXPECT_EQ(Call("GET", "/calibrations/cal_unknown").status, 404);
  EXPECT_EQ(Call("GET", "/calibrations/rec_0a1b2c").status, 404);
}

}  // namespace
}  // namespace drupe
