#include "service/webhooks.h"

#include <gtest/gtest.h>

#include <fstream>
#include <mutex>

#include "base/hmac.h"
#include "base/ids.h"
#include "http/server.h"
#include "jobs/sql/sql_job_store.h"
#include "service/open_database.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSecret = "a secret of some length";

/// A receiver on this machine, and a job store that is told of its jobs.
class WebhooksTest : public testing::Test {
 protected:
  WebhooksTest() {
    fs::create_directories(data_);
    database_ = OpenDatabase("", data_, "test").value();
    jobs_ = OpenJobStore(*database_, {.first_backoff_ms = 10, .max_backoff_ms = 20}).value();
    receiver_.router().Add("POST", "/hook", {}, [this](const Request& request, Response& response) {
      const std::lock_guard lock(mutex_);
      bodies_.push_back(ReadBody(request, 10'000).value());
      signatures_.emplace_back(request.Header("Drupe-Signature"));
      if (static_cast<int>(bodies_.size()) <= refusals_) response.status = 500;
      received_.Notify();
    });
    EXPECT_TRUE(receiver_.Bind().ok());
    listener_ = std::thread([this] { (void)receiver_.Serve(); });
  }
  ~WebhooksTest() override {
    receiver_.Stop();
    listener_.join();
    fs::remove_all(data_);
  }

  std::unique_ptr<Webhooks> Open(std::set<std::string> allowed = {"127.0.0.1"}, const std::string& secret = kSecret) {
    return std::move(Webhooks::Open(*database_, *jobs_, {secret, std::move(allowed)}, [](const Job& job) {
                       return Json{{"event", std::string("work.") + JobStateName(job.state)}, {"id", job.id}};
                     }).value());
  }
  std::string Url() const { return "http://127.0.0.1:" + std::to_string(receiver_.port()) + "/hook"; }
  std::string EndedJob() {
    const Job job = jobs_->Submit({.kind = "work"}).value();
    End();
    return job.id;
  }
  void End() {
    const Job job = *jobs_->Claim({"work"}, "w", 10'000).value();
    ASSERT_TRUE(jobs_->Fail(job.id, job.attempt, {"broken", "it broke", ""}, false).ok());
  }
  /// Waits until the receiver has been called `count` times.
  void WaitForCalls(int count) {
    for (std::uint64_t seen = 0;; seen = received_.WaitBeyond(seen, std::chrono::seconds(60))) {
      const std::lock_guard lock(mutex_);
      if (static_cast<int>(bodies_.size()) >= count) return;
    }
  }
  /// The call for a job, once it has ended.
  Job EndedCall(const std::string& job) {
    for (;;) {
      const std::uint64_t seen = jobs_->changes().version();
      const JobPage page = jobs_->List({"webhook", job, std::nullopt}, 10, "").value();
      if (!page.jobs.empty() && IsTerminal(page.jobs[0].state)) return page.jobs[0];
      jobs_->changes().WaitBeyond(seen, std::chrono::seconds(60));
    }
  }

  const fs::path data_ = fs::temp_directory_path() / NewId("webhooks");
  std::unique_ptr<Database> database_;
  std::unique_ptr<JobStore> jobs_;
  std::mutex mutex_;
  std::vector<std::string> bodies_, signatures_;
  int refusals_ = 0;
  ChangeSignal received_;
  Server receiver_{{}, nullptr};
  std::thread listener_;
};

TEST_F(WebhooksTest, TellsTheEndOfAJobSignedAndAgainAfterARefusal) {
  refusals_ = 2;
  const auto webhooks = Open();
  ASSERT_TRUE(webhooks->Start("test").ok());
  const std::string job = EndedJob();
  ASSERT_TRUE(webhooks->Subscribe(job, Url()).ok());
  EXPECT_EQ(EndedCall(job).state, JobState::kSucceeded);
  ASSERT_EQ(bodies_.size(), 3u);
  const Json body = ParseJson(bodies_[2]).value();
  EXPECT_EQ(body["event"], "work.failed");
  EXPECT_EQ(body["id"], job);
  const std::string& signature = signatures_[2];
  const std::string time = signature.substr(2, signature.find(',') - 2);
  EXPECT_EQ(signature, "t=" + time + ",v1=" + HmacSha256Hex(kSecret, time + "." + bodies_[2]));
}

TEST_F(WebhooksTest, SurvivesARestartAndIsCalledOncePerEnd) {
  const std::string job = EndedJob();
  ASSERT_TRUE(Open()->Subscribe(job, Url()).ok());
  EXPECT_EQ(Open()->QueueDue().value(), 1);
  EXPECT_EQ(Open()->QueueDue().value(), 0) << "it is told, whoever looks";
  const auto webhooks = Open();
  ASSERT_TRUE(webhooks->Start("test").ok());
  WaitForCalls(1);
  ASSERT_TRUE(jobs_->Retry(job).ok());
  End();
  WaitForCalls(2);
  EXPECT_EQ(ParseJson(bodies_[1]).value()["id"], job) << "a job that ends again is told again";
}

TEST_F(WebhooksTest, CallsNoPrivateAddressUnlessItsHostIsAllowed) {
  const auto webhooks = Open({});
  EXPECT_EQ(webhooks->Check(Url()).code(), "webhook_refused");
  EXPECT_EQ(webhooks->Check("http://169.254.169.254/latest/meta-data").code(), "webhook_refused");
  EXPECT_EQ(webhooks->Check("http://[::1]/").code(), "webhook_refused");
  EXPECT_EQ(webhooks->Check("file:///etc/passwd").code(), "invalid_webhook");
  EXPECT_TRUE(webhooks->Check("https://example.org/hook").ok());
  EXPECT_EQ(Open({}, "")->Check("https://example.org/hook").code(), "webhooks_off");
  // A name passes here, and is looked up when it is called.
  const std::string by_name = "http://localhost:" + std::to_string(receiver_.port()) + "/hook";
  EXPECT_TRUE(webhooks->Check(by_name).ok());
  ASSERT_TRUE(webhooks->Start("test").ok());
  const std::string job = EndedJob();
  ASSERT_TRUE(webhooks->Subscribe(job, by_name).ok());
  const Job call = EndedCall(job);
  EXPECT_EQ(call.state, JobState::kFailed);
  EXPECT_EQ(call.error->code, "webhook_refused");
  EXPECT_TRUE(bodies_.empty());
}

TEST(ReadWebhookOptions, NeedsASecretOfSomeLength) {
  const fs::path file = fs::temp_directory_path() / NewId("secret");
  ServiceOptions options;
  EXPECT_TRUE(ReadWebhookOptions(options)->secret.empty());
  options.webhook_secret = file.string();
  options.webhook_allow = "hooks.lan,10.0.0.7";
  std::ofstream(file) << "short\n";
  EXPECT_EQ(ReadWebhookOptions(options).status().code(), "invalid_option");
  std::ofstream(file) << kSecret << "\n";
  const WebhookOptions read = ReadWebhookOptions(options).value();
  EXPECT_EQ(read.secret, kSecret);
  EXPECT_EQ(read.allowed_hosts, (std::set<std::string>{"hooks.lan", "10.0.0.7"}));
  fs::remove(file);
}

}  // namespace
}  // namespace drupe
