#include "defect_analysis/analysis_service.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "base/digest.h"
#include "base/ids.h"
#include "defect_analysis/analysis_job.h"
#include "defect_analysis/routes.h"
#include "http/client.h"
#include "http/server.h"
#include "image/encode.h"
#include "jobs/job_runner.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"
#include "scene/cameras_json.h"
#include "scene/ply.h"
#include "scene/synthetic_fruit.h"
#include "service/references.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

constexpr char kId[] = "rec_0a1b2c";
constexpr std::chrono::seconds kPatience{60};

/// A server on a free port of loopback.
class RunningServer {
 public:
  explicit RunningServer(const std::function<void(Router&)>& add_routes) : server_({}, nullptr) {
    add_routes(server_.router());
    EXPECT_TRUE(server_.Bind().ok());
    thread_ = std::thread([this] { EXPECT_TRUE(server_.Serve().ok()); });
  }
  ~RunningServer() {
    server_.Stop();
    thread_.join();
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(server_.port()); }

 private:
  Server server_;
  std::thread thread_;
};

/// The files of a reconstruction of a plum with one spot.
std::map<std::string, std::string> MakeArtifacts() {
  PointCloud cloud;
  SyntheticFruit fruit;
  fruit.points = 20'000;
  fruit.spots.push_back({.direction = Eigen::Vector3d(1, 0, 0.2).normalized(), .radius_mm = 2});
  fruit.AddTo(cloud);
  SparseModel model;
  model.scale_source = ScaleSource::kBoard;
  model.camera.width = 1280;
  model.camera.height = 720;
  model.camera.fx = model.camera.fy = 1500;
  model.camera.cx = 640;
  model.camera.cy = 360;
  return {{"dense.ply", WritePly(cloud)},
          {"cameras.json", DumpJson(CamerasJson(model))},
          {"board.json", DumpJson(ToJson(MakeGridBoard()))}};
}

/// cameras.json of one view, which looks from 200 mm away at the plum's spot, and its photograph.
void AddPhotograph(std::map<std::string, std::string>& artifacts, std::map<std::string, std::string>& photographs) {
  SparseModel model = ParseCameras(ParseJson(artifacts.at("cameras.json")).value()).value();
  const Eigen::Vector3d z = -Eigen::Vector3d::UnitX(), x = Eigen::Vector3d::UnitZ().cross(z);
  View view;
  view.image = "00.png";
  view.cam_from_world = Rigid3();
  view.cam_from_world->rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  view.cam_from_world->translation = -(view.cam_from_world->rotation * Eigen::Vector3d(200, 0, 34));
  model.views = {view};
  artifacts["cameras.json"] = DumpJson(CamerasJson(model));
  RgbImage grey(model.camera.width, model.camera.height, 3);
  for (int y = 0; y < grey.height(); ++y) std::fill_n(grey.Row(y), 3 * grey.width(), std::uint8_t{128});
  photographs["00.png"] = EncodePng(grey).value();
}

/// The reconstruction service as the analysis sees it, with one reconstruction.
class FakeReconstruction {
 public:
  void AddRoutes(Router& router) {
    router.Add("GET", "/reconstructions/{id:rec}", {}, [this](const Request& request, Response& response) {
      if (request.Capture("id") != kId) return response.SetError(NotFound("job_not_found", "no such reconstruction"));
      response.SetJson(StatusJson());
    });
    router.Add("GET", "/reconstructions/{id:rec}/artifacts/{name}", {},
               [this](const Request& request, Response& response) {
                 ++downloads;
                 response.SetText(artifacts.at(request.Capture("name")), "application/octet-stream");
               });
  }

  std::map<std::string, std::string> artifacts = [] {
    static const std::map<std::string, std::string> kArtifacts = MakeArtifacts();
    return kArtifacts;
  }();
  std::map<std::string, std::string> photographs;  ///< by name
  std::string state = "succeeded";
  bool wrong_digests = false;
  std::atomic<int> downloads{0};

 private:
  Json StatusJson() const {
    Json listed = Json::array();
    for (const auto& [name, bytes] : artifacts) {
      const std::string digest = Sha256Hex(wrong_digests ? name : bytes);
      listed.push_back({{"name", name}, {"sha256", digest}, {"bytes", bytes.size()}});
    }
    Json names = Json::array(), digests = Json::array();
    for (const auto& [name, bytes] : photographs) {
      names.push_back(name);
      digests.push_back(Sha256Hex(bytes));
    }
    return {{"id", kId},
            {"status", state},
            {"quality", {{"registered", 36}}},
            {"timings", {{"stages", {{{"name", "dense"}, {"wall_s", 2.5}}}}}},
            {"artifacts", listed},
            {"provenance",
             {{"image_set", "set_1"},
              {"image_names", names},
              {"image_sha256", digests},
              {"calibration", nullptr},
              {"build", "0.1.0"}}}};
  }
};

class AnalysisServiceTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(directory_);
    Open();
  }
  void TearDown() override {
    Close();
    fs::remove_all(directory_);
  }

  void Open() {
    objects_ = DiskObjectStore::Open(directory_ / "objects").value();
    database_ = SqliteDatabase::Open(directory_ / "analysis.db").value();
    index_ = ReportIndex::Open(*database_).value();
    jobs_ = OpenJobStore(*database_, {.first_backoff_ms = 1, .max_backoff_ms = 1}).value();
    client_ = ReconstructionClient::Create(reconstruction_server_->url(), *objects_).value();
    job_.emplace(*client_, *objects_, *index_);
    service_.emplace(*jobs_, *index_, *objects_);
    webhooks_ = std::move(Webhooks::Open(*database_, *jobs_, {}, nullptr).value());
    server_ =
        std::make_unique<RunningServer>([&](Router& router) { AddAnalysisRoutes(*service_, *webhooks_, "", router); });
    api_ = Client::Create(server_->url()).value();
  }
  void StartRunner() {
    JobRunnerOptions options;
    options.heartbeat_ms = options.idle_poll_ms = 5;
    runner_ = std::make_unique<JobRunner>(*jobs_, options);
    runner_->Handle(std::string(kAnalyzeKind),
                    [&](const Job& job, const RunContext& context) { return job_->Run(job, context); });
    ASSERT_TRUE(runner_->Start().ok());
  }
  void Close() {
    runner_.reset();
    server_.reset();
    webhooks_.reset();
    jobs_.reset();
    database_.reset();
  }

  Result<Client::Reply> Analyze(const Json& options = Json::object(), const std::string& id = kId) {
    return api_->Post("/analyze", {{"reconstruction", id}, {"options", options}});
  }
  /// The reply about the report once it is not 202.
  Result<Client::Reply> WaitForReport(const std::string& id = kId) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
      auto reply = api_->Get("/reports/" + id);
      const bool waiting = reply.ok() && reply->json.contains("status");
      if (!waiting || std::chrono::steady_clock::now() > deadline) return reply;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  std::string Download(const std::string& path) {
    std::string bytes;
    const auto append = [&](std::string_view piece) {
      bytes.append(piece);
      return true;
    };
    EXPECT_TRUE(api_->Download(path, 1 << 24, append).ok()) << path;
    return bytes;
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("analysistest");
  FakeReconstruction reconstruction_;
  std::unique_ptr<RunningServer> reconstruction_server_ =
      std::make_unique<RunningServer>([this](Router& router) { reconstruction_.AddRoutes(router); });
  std::unique_ptr<ObjectStore> objects_;
  std::unique_ptr<SqliteDatabase> database_;
  std::optional<ReportIndex> index_;
  std::unique_ptr<JobStore> jobs_;
  std::optional<ReconstructionClient> client_;
  std::optional<AnalysisJob> job_;
  std::optional<AnalysisService> service_;
  std::unique_ptr<Webhooks> webhooks_;
  std::unique_ptr<RunningServer> server_;
  std::optional<Client> api_;
  std::unique_ptr<JobRunner> runner_;
};

TEST_F(AnalysisServiceTest, GivesTheReportOfAReconstruction) {
  const auto accepted = Analyze();
  ASSERT_TRUE(accepted.ok()) << accepted.status().ToString();
  EXPECT_EQ(accepted->http_status, 202);
  EXPECT_EQ(accepted->json["status"], "queued");
  EXPECT_EQ(accepted->json["links"]["csv"], "/reports/rec_0a1b2c.csv");
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c")->json["status"], "queued");
  StartRunner();
  const auto report = WaitForReport();
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  EXPECT_EQ(report->json["id"], kId);
  EXPECT_EQ(report->json["unit"], "mm");
  EXPECT_EQ(report->json["quality"]["registered"], 36);
  EXPECT_EQ(report->json["provenance"]["image_set"], "set_1");
  EXPECT_EQ(report->json["timings_s"]["dense"], 2.5);
  ASSERT_EQ(report->json["fruits"].size(), 1u);
  ASSERT_EQ(report->json["fruits"][0]["defects"].size(), 1u);
  const auto listed = api_->Get("/reports?grade=" + report->json["fruits"][0]["grade"].get<std::string>());
  EXPECT_EQ(listed->json["reports"][0]["id"], kId);
  EXPECT_EQ(listed->json["reports"][0]["defects"], 1);
  const std::string csv = Download("/reports/rec_0a1b2c.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2) << csv;
}

TEST_F(AnalysisServiceTest, SameRequestIsTheSameJobOtherOptionsTakeItsPlace) {
  ASSERT_TRUE(Analyze().ok());
  ASSERT_TRUE(Analyze().ok());
  EXPECT_EQ(jobs_->Counts()->queued, 1);
  ASSERT_TRUE(Analyze({{"plane", {{"iterations", 9}}}}).ok());
  EXPECT_EQ(jobs_->Counts()->queued, 2);
  EXPECT_EQ(service_->Find(kId)->job.payload["options"]["plane"]["iterations"], 9);
  ASSERT_TRUE(Analyze().ok());
  EXPECT_EQ(service_->Find(kId)->job.payload["options"], Json::object());
}

TEST_F(AnalysisServiceTest, ObjectsOfASharedStoreAreNotDownloaded) {
  for (const auto& [name, bytes] : reconstruction_.artifacts) ASSERT_TRUE(objects_->Put(bytes).ok());
  ASSERT_TRUE(Analyze().ok());
  StartRunner();
  ASSERT_TRUE(WaitForReport().ok());
  EXPECT_EQ(reconstruction_.downloads, 0);
}

TEST_F(AnalysisServiceTest, KeepsTheFilesOfAReport) {
  AddPhotograph(reconstruction_.artifacts, reconstruction_.photographs);
  ASSERT_TRUE(objects_->Put(reconstruction_.photographs.at("00.png")).ok());
  ASSERT_TRUE(Analyze().ok());
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts")->json, Json::parse(R"({"artifacts": []})"));
  StartRunner();
  ASSERT_TRUE(WaitForReport().ok());
  const std::set<std::string> referenced = ReferencedDigests(*database_).value();
  const Json listed = api_->Get("/reports/rec_0a1b2c/artifacts")->json["artifacts"];
  std::vector<std::string> names;
  for (const Json& artifact : listed) {
    names.push_back(artifact["name"]);
    EXPECT_TRUE(referenced.contains(artifact["sha256"])) << "garbage would be collected: " << artifact;
    EXPECT_EQ(Sha256Hex(Download("/reports/rec_0a1b2c/artifacts/" + names.back())), artifact["sha256"]);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"contact_sheet.png", "defect_1_1.png", "defects.ply", "observations.json",
                                             "report.csv", "report.json"}));
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts/report.json")->json["id"], kId);
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts/x.png").status().code(), "artifact_not_found");
  EXPECT_EQ(api_->Get("/reports/rec_unknown/artifacts").status().code(), "report_not_found");
}

TEST_F(AnalysisServiceTest, WithoutPhotographsThereAreNoPictures) {
  AddPhotograph(reconstruction_.artifacts, reconstruction_.photographs);  // but not to the store
  ASSERT_TRUE(Analyze().ok());
  StartRunner();
  ASSERT_TRUE(WaitForReport().ok());
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts")->json["artifacts"].size(), 4u);
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts/contact_sheet.png").status().code(), "artifact_not_found");
}

TEST_F(AnalysisServiceTest, APhotographThatCannotBeReadCostsOnlyItsPictures) {
  AddPhotograph(reconstruction_.artifacts, reconstruction_.photographs);
  reconstruction_.photographs["00.png"] = "no picture";
  ASSERT_TRUE(objects_->Put("no picture").ok());
  ASSERT_TRUE(Analyze().ok());
  StartRunner();
  ASSERT_TRUE(WaitForReport().ok());
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c/artifacts/defect_1_1.png").status().code(), "artifact_not_found");
}

TEST_F(AnalysisServiceTest, FinishedReportsNeedNoReconstructionService) {
  ASSERT_TRUE(Analyze().ok());
  StartRunner();
  ASSERT_TRUE(WaitForReport().ok());
  reconstruction_server_.reset();
  Close();
  reconstruction_server_ = std::make_unique<RunningServer>([](Router&) {});
  Open();
  EXPECT_EQ(api_->Get("/reports/rec_0a1b2c")->json["id"], kId);
}

TEST_F(AnalysisServiceTest, InterruptedJobIsFinishedAfterARestart) {
  ASSERT_TRUE(Analyze().ok());
  ASSERT_TRUE(jobs_->Claim({std::string(kAnalyzeKind)}, "a worker that dies", 60'000)->has_value());
  Close();
  Open();
  StartRunner();
  EXPECT_EQ(WaitForReport()->json["id"], kId);
}

TEST_F(AnalysisServiceTest, ReportLeftByACrashBeforeTheEndOfTheJobIsKept) {
  ASSERT_TRUE(Analyze().ok());
  const Job job = jobs_->Claim({std::string(kAnalyzeKind)}, "w", 60'000).value().value();
  const Json first = job_->Run(job, {}).value();
  const std::string created_at = FormatUtc(index_->FindByJob(job.id).value()->created_ms);
  EXPECT_EQ(job_->Run(job, {}).value(), first);
  ASSERT_TRUE(jobs_->Complete(job.id, job.attempt, first).ok());
  EXPECT_EQ(WaitForReport()->json["created_at"], created_at);
}

TEST_F(AnalysisServiceTest, TellsWhyThereIsNoReport) {
  reconstruction_.artifacts.erase("dense.ply");
  ASSERT_TRUE(Analyze().ok());
  ASSERT_TRUE(Analyze(Json::object(), "rec_unknown").ok());
  StartRunner();
  const auto no_cloud = WaitForReport();
  EXPECT_EQ(no_cloud.status().code(), "no_dense_cloud");
  EXPECT_EQ(no_cloud.status().kind(), StatusKind::kUnprocessable);
  EXPECT_EQ(WaitForReport("rec_unknown").status().code(), "job_not_found");
}

TEST_F(AnalysisServiceTest, AskingAgainRevivesAFailedAnalysis) {
  reconstruction_.wrong_digests = true;
  ASSERT_TRUE(Analyze().ok());
  StartRunner();
  const auto failed = WaitForReport();
  EXPECT_EQ(failed.status().code(), "attempts_exhausted");
  EXPECT_NE(failed.status().message().find("artifact_damaged"), std::string::npos) << failed.status().message();
  reconstruction_.wrong_digests = false;
  ASSERT_TRUE(Analyze().ok());
  EXPECT_TRUE(WaitForReport().ok());
}

TEST_F(AnalysisServiceTest, WaitsForAReconstructionThatIsNotFinished) {
  reconstruction_.state = "running";
  ASSERT_TRUE(Analyze().ok());
  const Job job = jobs_->Claim({std::string(kAnalyzeKind)}, "w", 60'000).value().value();
  const Status waiting = job_->Run(job, {}).status();
  EXPECT_EQ(waiting.code(), "reconstruction_not_finished");
  EXPECT_EQ(waiting.kind(), StatusKind::kUnavailable) << "so that it is tried again";
}

TEST_F(AnalysisServiceTest, RefusesBadRequests) {
  const auto code = [&](const Json& body) { return api_->Post("/analyze", body).status().code(); };
  EXPECT_EQ(code(Json::object()), "invalid_request");
  EXPECT_EQ(code(Json::array()), "invalid_request");
  EXPECT_EQ(code({{"reconstruction", 7}}), "invalid_request");
  EXPECT_EQ(code({{"reconstruction", "../x"}}), "invalid_id");
  EXPECT_EQ(code({{"reconstruction", kId}, {"colour", 1}}), "unknown_option");
  EXPECT_EQ(code({{"reconstruction", kId}, {"options", {{"plane", {{"x", 1}}}}}}), "unknown_option");
  const auto list_code = [&](const std::string& query) { return api_->Get("/reports?" + query).status().code(); };
  EXPECT_EQ(list_code("grade=mouldy"), "invalid_parameter");
  EXPECT_EQ(list_code("since=yesterday"), "invalid_parameter");
  EXPECT_EQ(list_code("limit=0"), "invalid_parameter");
  EXPECT_EQ(list_code("cursor=x"), "invalid_cursor");
  EXPECT_EQ(api_->Get("/reports/rec_unknown").status().code(), "report_not_found");
}

}  // namespace
}  // namespace drupe
