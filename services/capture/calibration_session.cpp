#include "capture/calibration_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace drupe {
namespace {

const Migrations kSessionSchema = {"CREATE TABLE calibration_sessions (id TEXT PRIMARY KEY, document TEXT NOT NULL);"};

constexpr double kPixelUnit = 0.01;  // corners are kept as whole numbers of this

Json PictureJson(const SessionPicture& picture) {
  Json pixels = Json::array();
  for (const Eigen::Vector2d& pixel : picture.corners.pixels) {
    pixels.push_back(std::lround(pixel.x() / kPixelUnit));
    pixels.push_back(std::lround(pixel.y() / kPixelUnit));
  }
  return {{"name", picture.name},
          {"sha256", picture.sha256},
          {"corners", picture.corners.indices},
          {"pixels", std::move(pixels)}};
}

SessionPicture PictureOf(const Json& json) {
  SessionPicture picture{json.at("name").get<std::string>(), json.at("sha256").get<std::string>(), {}};
  picture.corners.indices = json.at("corners").get<std::vector<int>>();
  const auto pixels = json.at("pixels").get<std::vector<double>>();
  for (std::size_t i = 0; i + 1 < pixels.size(); i += 2) {
    picture.corners.pixels.emplace_back(pixels[i] * kPixelUnit, pixels[i + 1] * kPixelUnit);
  }
  return picture;
}

Json DocumentOf(const CalibrationSession& session) {
  Json pictures = Json::array();
  for (const SessionPicture& picture : session.pictures) pictures.push_back(PictureJson(picture));
  return {{"camera", ToJson(session.camera)}, {"pattern", ToJson(session.pattern)},
          {"lens", session.binding.lens},     {"serial", session.binding.serial},
          {"width", session.width},           {"height", session.height},
          {"pictures", std::move(pictures)}};
}

Status ReadPictures(const Json& document, CalibrationSession& session) {
  try {
    session.binding.serial = document.at("serial").get<std::string>();
    session.width = document.at("width").get<int>(), session.height = document.at("height").get<int>();
    for (const Json& picture : document.at("pictures")) session.pictures.push_back(PictureOf(picture));
    return Status::Ok();
  } catch (const Json::exception& error) {
    return Internal("bad_session", error.what());
  }
}

}  // namespace

Guidance CalibrationSession::Guide() const {
  std::vector<PatternCorners> corners;
  for (const SessionPicture& picture : pictures) corners.push_back(picture.corners);
  return drupe::Guide(corners, pattern, std::max(width, 1), std::max(height, 1));
}

CalibrationRequest CalibrationSession::Request() const {
  CalibrationRequest request;
  request.pattern = pattern, request.camera = binding;
  for (const SessionPicture& picture : pictures) request.pictures.push_back({picture.name, picture.sha256});
  return request;
}

Result<CalibrationSession> ParseSession(const Json& json) {
  if (!json.is_object()) return InvalidArgument("invalid_request", "the body must be a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (key == "camera" || key == "pattern" || key == "lens") continue;
    return InvalidArgument("unknown_option", "there is no option " + key, key);
  }
  CalibrationSession session;
  DRUPE_ASSIGN_OR_RETURN(session.camera, ParseCameraChoice(json.value("camera", Json())));
  DRUPE_ASSIGN_OR_RETURN(session.pattern, ParseCheckerboard(json.value("pattern", Json())));
  DRUPE_ASSIGN_OR_RETURN(session.binding, ParseCameraBinding({{"lens", json.value("lens", Json())}}));
  return session;
}

Json ToJson(const CalibrationSession& session) {
  const Guidance guidance = session.Guide();
  Json images = Json::array();
  for (std::size_t i = 0; i < session.pictures.size(); ++i) {
    images.push_back({{"name", session.pictures[i].name},
                      {"sha256", session.pictures[i].sha256},
                      {"corners", session.pictures[i].corners.size()},
                      {"pose", ToJson(guidance.poses[i])}});
  }
  Json camera = ToJson(session.camera);
  camera.update(ToJson(session.binding));
  return {{"id", session.id},
          {"camera", std::move(camera)},
          {"pattern", ToJson(session.pattern)},
          {"width", session.width},
          {"height", session.height},
          {"images", std::move(images)},
          {"guidance", ToJson(guidance)}};
}

Result<std::unique_ptr<SessionStore>> SessionStore::Open(Database& database) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("calibration_sessions", kSessionSchema));
  return std::unique_ptr<SessionStore>(new SessionStore(database));
}

Status SessionStore::Put(const CalibrationSession& session) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO calibration_sessions (id, document) VALUES (?, ?)"
                                             " ON CONFLICT (id) DO UPDATE SET document = excluded.document"));
    return insert->Bind(session.id).Bind(DumpJson(DocumentOf(session))).Run();
  });
}

Result<CalibrationSession> SessionStore::Get(std::string_view id) {
  Json document;
  const Status status = database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto row, database_.Prepare("SELECT document FROM calibration_sessions WHERE id = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, row->Bind(id).Step());
    if (!found) return NotFound("session_not_found", "there is no calibration session " + std::string(id));
    DRUPE_ASSIGN_OR_RETURN(document, ParseJson(row->Text(0)));
    return Status::Ok();
  });
  DRUPE_RETURN_IF_ERROR(status);
  Json asked = Json::object();
  for (const char* key : {"camera", "pattern", "lens"}) asked[key] = document.value(key, Json());
  DRUPE_ASSIGN_OR_RETURN(CalibrationSession session, ParseSession(asked));
  session.id = id;
  DRUPE_RETURN_IF_ERROR(ReadPictures(document, session));
  return session;
}

Status SessionStore::Remove(std::string_view id) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto remove, database_.Prepare("DELETE FROM calibration_sessions WHERE id = ?"));
    return remove->Bind(id).Run();
  });
}

}  // namespace drupe
