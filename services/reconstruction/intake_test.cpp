#include "reconstruction/intake.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "base/ids.h"
#include "http/request.h"
#include "http/text_body.h"
#include "jobs/sqlite/database.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/reconstruct_request.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

std::string FromHex(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

/// Grey PNG files of 1x1 and 2x1 pixels.
const std::string kSmall = FromHex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b550000000a49444154789c63600700000900"
    "082023c38c0000000049454e44ae426082");
const std::string kWide = FromHex(
    "89504e470d0a1a0a0000000d4948445200000002000000010800000000d14920560000000b49444154789c63e0e40400001e"
    "0013eb1972250000000049454e44ae426082");

class IntakeTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() / NewId("test");
    std::filesystem::create_directories(directory_);
    objects_ = std::move(DiskObjectStore::Open(directory_ / "objects").value());
    database_ = std::move(SqliteDatabase::Open(directory_ / "test.db").value());
    sets_ = std::move(ImageSetStore::Open(*database_, limits_).value());
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  static std::string Part(const std::string& disposition, const std::string& bytes) {
    return "--b\r\nContent-Disposition: form-data; " + disposition + "\r\n\r\n" + bytes + "\r\n";
  }
  static std::string Image(const std::string& name, const std::string& bytes = kSmall) {
    return Part("name=images; filename=" + name, bytes);
  }
  static std::string ThreeImages() { return Image("b.png") + Image("a.png") + Image("c.png"); }

  Result<ReconstructRequest> ReadForm(const std::string& parts) {
    TextBody body(parts + "--b--\r\n");
    Request request;
    request.headers.emplace("Content-Type", "multipart/form-data; boundary=b");
    request.body = &body;
    return ReadReconstructForm(request, *objects_, *sets_, limits_);
  }
  std::string FormCode(const std::string& parts) {
    const Result<ReconstructRequest> form = ReadForm(parts);
    return form.ok() ? "ok" : form.status().code();
  }
  Result<ReconstructRequest> ReadJson(const std::string& text) {
    TextBody body(text);
    Request request;
    request.headers.emplace("Content-Type", "application/json");
    request.body = &body;
    return ReadReconstructJson(request, *sets_, limits_);
  }

  StoredImage Stored(const std::string& name, const std::string& bytes = kSmall) {
    return StoreImage(*objects_, name, bytes, limits_).value();
  }

  Limits limits_;
  std::filesystem::path directory_;
  std::unique_ptr<ObjectStore> objects_;
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<ImageSetStore> sets_;
};

TEST_F(IntakeTest, FormNominal) {
  const Result<ReconstructRequest> form =
      ReadForm(ThreeImages() + Part("name=options", R"({"run_dense": false, "analyze": false})") +
               Part("name=board; filename=board.json", "\"default\""));
  ASSERT_TRUE(form.ok()) << form.status().message();
  ASSERT_EQ(form->images.size(), 3u);
  EXPECT_EQ(form->images[0].name, "a.png");
  EXPECT_EQ(objects_->Get(form->images[0].sha256).value(), kSmall);
  EXPECT_FALSE(form->analyze);
  EXPECT_EQ(form->options.dump(), R"({"run_dense":false})");
  EXPECT_EQ(form->board->corners_mm.size(), 81u);
  EXPECT_EQ(sets_->Get(form->image_set).value().images, form->images);
}

TEST_F(IntakeTest, TheSameFormIsTheSamePayload) {
  const std::string parts = ThreeImages() + Image("bad.jpg", "no picture");
  EXPECT_EQ(ToPayload(ReadForm(parts).value()), ToPayload(ReadForm(parts).value()));
  EXPECT_NE(ReadForm(parts)->image_set, ReadForm(parts + Image("d.png"))->image_set);
}

TEST_F(IntakeTest, PayloadRoundTrip) {
  const Json payload = ToPayload(ReadForm(ThreeImages() + Part("name=options", R"({"analysis": {"x": 1}})")).value());
  const Result<ReconstructRequest> back = FromPayload(payload);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(ToPayload(*back), payload);
  EXPECT_EQ(FromPayload({{"image_set", 3}}).status().kind(), StatusKind::kInternal);
}

TEST_F(IntakeTest, BadPicturesAreRefusedByName) {
  const Result<ReconstructRequest> form = ReadForm(ThreeImages() + Image("text.jpg", "hello") + Image("empty.png", "") +
                                                   Image("cut.png", kSmall.substr(0, 50)) + Image("wide.png", kWide));
  ASSERT_TRUE(form.ok()) << form.status().message();
  EXPECT_EQ(form->images.size(), 3u);
  std::map<std::string, std::string> codes;
  for (const Json& entry : form->refused_images) codes[entry.at("name")] = entry.at("code");
  EXPECT_EQ(codes["text.jpg"], "unsupported_image");
  EXPECT_EQ(codes["empty.png"], "bad_image");
  EXPECT_EQ(codes["cut.png"], "bad_image");
  EXPECT_EQ(codes["wide.png"], "image_size_mismatch");
}

TEST_F(IntakeTest, TooFewRemain) {
  EXPECT_EQ(FormCode(Image("a.png") + Image("b.png")), "too_few_images");
  const Result<ReconstructRequest> form = ReadForm(Image("a.png") + Image("x.jpg", "hello") + Image("b.png"));
  EXPECT_EQ(form.status().code(), "unsupported_image");
  EXPECT_NE(form.status().message().find("x.jpg"), std::string::npos);
}

TEST_F(IntakeTest, WrongParts) {
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=colour", "red")), "unknown_part");
  EXPECT_EQ(FormCode(ThreeImages() + Image("a.png")), "duplicate_name");
  EXPECT_EQ(FormCode(ThreeImages() + Image("../a.png")), "invalid_name");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=images", kSmall)), "invalid_name");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", "{}") + Part("name=options", "{}")), "duplicate_part");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", "{")), "invalid_json");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", "[]")), "invalid_option");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", R"({"analyze": 1})")), "invalid_option");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", R"({"colour": 1})")), "unknown_option");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=options", std::string(2 << 20, ' '))), "json_too_large");
  EXPECT_EQ(FormCode(ThreeImages() + Part("name=board", "{}")), "invalid_board");
  limits_.max_images = 3;
  EXPECT_EQ(FormCode(ThreeImages() + Image("d.png")), "too_many_images");
}

TEST_F(IntakeTest, SetGrowsImageByImage) {
  const std::string id = sets_->Create().value().id;
  EXPECT_EQ(sets_->PutImage(id, Stored("b.png")).value(), PutOutcome::kAdded);
  EXPECT_EQ(sets_->PutImage(id, Stored("b.png")).value(), PutOutcome::kUnchanged);
  EXPECT_EQ(sets_->PutImage(id, Stored("a.png", kWide)).status().code(), "image_size_mismatch");
  EXPECT_EQ(sets_->PutImage(id, Stored("b.png", kWide)).value(), PutOutcome::kReplaced);
  EXPECT_EQ(sets_->PutImage(id, Stored("a.png", kWide)).value(), PutOutcome::kAdded);
  const ImageSet set = sets_->Get(id).value();
  ASSERT_EQ(set.images.size(), 2u);
  EXPECT_EQ(set.images[0].name, "a.png");
  EXPECT_EQ(set.images[1].width, 2);
  EXPECT_EQ(sets_->PutImage("set_none", Stored("a.png")).status().code(), "image_set_not_found");
}

TEST_F(IntakeTest, SetSurvivesReopening) {
  const std::string id = sets_->Create().value().id;
  ASSERT_TRUE(sets_->PutImage(id, Stored("a.png")).ok());
  sets_.reset();
  database_.reset();
  database_ = std::move(SqliteDatabase::Open(directory_ / "test.db").value());
  sets_ = std::move(ImageSetStore::Open(*database_, limits_).value());
  EXPECT_EQ(sets_->Get(id).value().images.size(), 1u);
}

TEST_F(IntakeTest, JsonRequests) {
  const std::string id = ReadForm(ThreeImages()).value().image_set;
  const Result<ReconstructRequest> request =
      ReadJson(R"({"image_set": ")" + id + R"(", "analyze": false, "options": {"run_dense": false}})");
  ASSERT_TRUE(request.ok()) << request.status().message();
  EXPECT_EQ(request->images.size(), 3u);
  EXPECT_FALSE(request->analyze);
  EXPECT_EQ(ReadJson("[]").status().code(), "invalid_request");
  EXPECT_EQ(ReadJson(R"({"image_set": 7})").status().code(), "invalid_request");
  EXPECT_EQ(ReadJson(R"({"image_set": "../etc"})").status().code(), "invalid_id");
  EXPECT_EQ(ReadJson(R"({"image_set": "set_none"})").status().code(), "image_set_not_found");
  EXPECT_EQ(ReadJson(R"({"image_set": "set_none", "colour": 1})").status().code(), "unknown_option");
  const std::string empty = sets_->Create().value().id;
  EXPECT_EQ(ReadJson(R"({"image_set": ")" + empty + "\"}").status().code(), "too_few_images");
}

}  // namespace
}  // namespace drupe
