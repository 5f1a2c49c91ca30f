#include <gtest/gtest.h>

#include "capture/session_grab.h"
#include "capture/simulator/rig_fixture.h"
#include "capture/store_fixture.h"

namespace drupe {
namespace {

/// Sessions with a camera that sees the sample's calibration pictures, one at each angle of the table.
class SessionTest : public StoreTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(StoreTest::SetUp());
    sessions_ = Open<SessionStore>();
    rig_ = StartRig({}, "calibration");
  }

  CalibrationSession Session(const std::string& camera) {
    auto session =
        ParseSession({{"camera", {{"id", camera}, {"exposure_us", 4000}}},
                      {"lens", "25 mm"},
                      {"pattern", {{"pattern", "checkerboard"}, {"inner_corners", {11, 8}}, {"square_mm", 6}}}});
    EXPECT_TRUE(session.ok()) << session.status().ToString();
    session->id = "cses_1";
    return *session;
  }

  std::unique_ptr<SessionStore> sessions_;
  std::unique_ptr<SimulatedRig> rig_;
};

TEST_F(SessionTest, KeepsWhatShowsSomethingNewAndSaysWhatIsMissing) {
  CalibrationSession session = Session(rig_->camera_id());
  const auto first = TakeSessionPicture(session, *objects_, {});
  ASSERT_TRUE(first.ok()) << first.status().ToString();
  EXPECT_TRUE(first->kept) << first->reason;
  EXPECT_EQ(first->corners, 88);
  EXPECT_FALSE(first->preview.empty());
  const auto again = TakeSessionPicture(session, *objects_, {});
  ASSERT_TRUE(again.ok()) << again.status().ToString();
  EXPECT_FALSE(again->kept);
  EXPECT_NE(again->reason.find("the same as 000.jpg"), std::string::npos) << again->reason;
  rig_->Turn(36);  // to the next picture
  EXPECT_TRUE(TakeSessionPicture(session, *objects_, {})->kept);
  ASSERT_EQ(session.pictures.size(), 2U);
  EXPECT_TRUE(objects_->Contains(session.pictures[1].sha256));
  EXPECT_FALSE(session.Guide().missing.empty());

  ASSERT_TRUE(sessions_->Put(session).ok());
  const auto kept = sessions_->Get("cses_1");
  ASSERT_TRUE(kept.ok()) << kept.status().ToString();
  EXPECT_EQ(ToJson(*kept)["camera"], ToJson(session)["camera"]);
  EXPECT_EQ(kept->pictures[1].corners.size(), session.pictures[1].corners.size());
  EXPECT_EQ(kept->Request().pictures[0].sha256, session.pictures[0].sha256);
  EXPECT_EQ(kept->Request().camera.lens, "25 mm");
  EXPECT_FALSE(kept->binding.serial.empty());
  ASSERT_TRUE(sessions_->Remove("cses_1").ok());
  EXPECT_EQ(sessions_->Get("cses_1").status().code(), "session_not_found");
}

TEST_F(SessionTest, RefusesAnotherCameraAndBadRequests) {
  CalibrationSession session = Session(rig_->camera_id());
  session.width = 640, session.height = 480, session.binding.serial = "other";
  EXPECT_EQ(TakeSessionPicture(session, *objects_, {}).status().code(), "camera_changed");
  EXPECT_EQ(ParseSession({{"pattern", {{"pattern", "circles"}}}}).status().code(), "invalid_pattern");
  EXPECT_EQ(ParseSession({{"colour", 1}}).status().code(), "unknown_option");
  EXPECT_EQ(ParseSession({{"camera", 3}}).status().field(), "camera");
}

}  // namespace
}  // namespace drupe
