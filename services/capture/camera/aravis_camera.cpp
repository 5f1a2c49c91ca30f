#include <arv.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>

#include "capture/camera/aravis_clock.h"
#include "capture/camera/aravis_handles.h"
#include "capture/camera/aravis_settings.h"
#include "capture/camera/camera.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr std::uint64_t kMaxPayloadBytes = std::uint64_t{256} << 20;

Status Lost() {
  return {StatusKind::kUnavailable, "camera_lost", "the camera is no longer reachable"};
}

Result<FrameLayout> LayoutOf(ArvPixelFormat format) {
  switch (format) {
    case ARV_PIXEL_FORMAT_MONO_8:
      return FrameLayout::kMono;
    case ARV_PIXEL_FORMAT_RGB_8_PACKED:
      return FrameLayout::kRgb;
    case ARV_PIXEL_FORMAT_BAYER_GR_8:
      return FrameLayout::kBayerGr;
    case ARV_PIXEL_FORMAT_BAYER_RG_8:
      return FrameLayout::kBayerRg;
    case ARV_PIXEL_FORMAT_BAYER_GB_8:
      return FrameLayout::kBayerGb;
    case ARV_PIXEL_FORMAT_BAYER_BG_8:
      return FrameLayout::kBayerBg;
    default:
      return Unprocessable("camera_refused", "the camera sends a pixel format that was not asked for");
  }
}

/// When the frame's first packet came: Aravis notes the time of day.
SteadyClock::time_point ReceivedAt(ArvBuffer* buffer) {
  const std::int64_t age_ns =
      g_get_real_time() * 1000 - static_cast<std::int64_t>(arv_buffer_get_system_timestamp(buffer));
  const std::int64_t plausible = std::clamp<std::int64_t>(age_ns, 0, 10'000'000'000);
  return SteadyClock::now() - std::chrono::nanoseconds(plausible);
}

/// Lets the thread that takes packets go before others where the system permits it: what it leaves lying is lost.
void HurryStream(void* /*unused*/, ArvStreamCallbackType type, ArvBuffer* /*unused*/) {
  constexpr int kNice = -15;
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT) static_cast<void>(setpriority(PRIO_PROCESS, 0, kNice));  // 0: the thread
}

class AravisCamera : public Camera {
 public:
  AravisCamera(GObjectPointer<ArvCamera> camera, const CameraOptions& options)
      : camera_(std::move(camera)), options_(options) {}
  ~AravisCamera() override {
    const Status ignored = Stop();  // a camera that is gone needs no goodbye
    (void)ignored;
  }

  Status Configure() {
    DRUPE_RETURN_IF_ERROR(ApplyCameraOptions(camera_.get(), options_));
    AravisError error;
    int x = 0, y = 0;
    arv_camera_get_region(camera_.get(), &x, &y, &width_, &height_, error.out());
    DRUPE_RETURN_IF_ERROR(error.Take("the region"));
    ReadIdentity();
    g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(OnControlLost), &lost_);
    return Status::Ok();
  }

  const CameraIdentity& identity() const override { return identity_; }
  int width() const override { return width_; }
  int height() const override { return height_; }

  Status Start() override {
    if (stream_) return Status::Ok();
    CompareClocks(camera_.get(), clock_);
    AravisError error;
    stream_.reset(arv_camera_create_stream(camera_.get(), HurryStream, nullptr, error.out()));
    DRUPE_RETURN_IF_ERROR(error.Take("the stream"));
    if (!stream_) return Lost();
    TuneStream();
    DRUPE_RETURN_IF_ERROR(PushBuffers());
    arv_camera_start_acquisition(camera_.get(), error.out());
    return error.Take("the start");
  }

  Status Stop() override {
    if (!stream_) return Status::Ok();
    AravisError error;
    if (!lost_) arv_camera_stop_acquisition(camera_.get(), error.out());
    past_ = counters();
    stream_.reset();
    return error.Take("the stop");
  }

  Status FireTrigger() override {
    if (lost_) return Lost();
    AravisError error;
    arv_camera_software_trigger(camera_.get(), error.out());
    return error.Take("the trigger");
  }

  Result<RawFrame> NextFrame(milliseconds timeout) override {
    const auto deadline = SteadyClock::now() + timeout;
    while (stream_ && !lost_) {
      const auto left = deadline - SteadyClock::now();
      if (left <= SteadyClock::duration::zero()) return TimedOut();
      const milliseconds slice = std::min(std::chrono::duration_cast<milliseconds>(left), milliseconds(100));
      const auto wait_us = static_cast<guint64>(std::max<long>(slice.count(), 1) * 1000);
      ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), wait_us);
      if (buffer == nullptr) continue;
      Result<RawFrame> frame = Copy(buffer);
      arv_stream_push_buffer(stream_.get(), buffer);
      return frame;
    }
    return Lost();
  }

  void DiscardFrames() override {
    while (stream_) {
      ArvBuffer* buffer = arv_stream_try_pop_buffer(stream_.get());
      if (buffer == nullptr) return;
      arv_stream_push_buffer(stream_.get(), buffer);
    }
  }

  CameraCounters counters() const override {
    CameraCounters sum = past_;
    if (!stream_) return sum;
    guint64 frames = 0, failures = 0, underruns = 0, resent = 0, missing = 0;
    arv_stream_get_statistics(stream_.get(), &frames, &failures, &underruns);
    if (ARV_IS_GV_STREAM(stream_.get())) {
      arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    }
    sum.frames += static_cast<std::int64_t>(frames);
    sum.incomplete_frames += static_cast<std::int64_t>(failures);
    sum.dropped_frames += static_cast<std::int64_t>(underruns);
    sum.resent_packets += static_cast<std::int64_t>(resent);
    sum.missing_packets += static_cast<std::int64_t>(missing);
    return sum;
  }

 private:
  static void OnControlLost(ArvDevice*, std::atomic<bool>* lost) { *lost = true; }

  void ReadIdentity() {
    const auto text = [](const char* value) { return std::string(value != nullptr ? value : ""); };
    AravisError error;  // a name that cannot be read stays empty
    identity_.vendor = text(arv_camera_get_vendor_name(camera_.get(), nullptr));
    identity_.model = text(arv_camera_get_model_name(camera_.get(), nullptr));
    identity_.serial = text(arv_camera_get_device_serial_number(camera_.get(), nullptr));
    identity_.id = identity_.vendor + "-" + identity_.model + "-" + identity_.serial;
  }

  /// The socket holds two frames, as far as the system lets it: a machine that is busy with others loses none of one.
  void TuneStream() {
    if (!ARV_IS_GV_STREAM(stream_.get())) return;
    const guint payload = arv_camera_get_payload(camera_.get(), nullptr);
    const gint held = static_cast<gint>(2 * std::min<std::uint64_t>(payload, kMaxPayloadBytes));
    if (held > 0) {
      g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", held,
                   nullptr);
    }
    const int resend = options_.resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER;
    g_object_set(stream_.get(), "packet-resend", resend, "packet-request-ratio", 1.0, "initial-packet-timeout",
                 static_cast<guint>(1000 * options_.packet_timeout_ms), "packet-timeout",
                 static_cast<guint>(1000 * options_.packet_timeout_ms), "frame-retention",
                 static_cast<guint>(1000 * options_.frame_timeout_ms), nullptr);
  }

  Status PushBuffers() {
    AravisError error;
    const std::uint64_t payload = arv_camera_get_payload(camera_.get(), error.out());
    DRUPE_RETURN_IF_ERROR(error.Take("the payload"));
    if (payload == 0 || payload > kMaxPayloadBytes) {
      return Unprocessable("camera_refused", "a frame would have " + std::to_string(payload) + " bytes");
    }
    for (int i = 0; i < options_.buffers; ++i) {
      arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload, nullptr));
    }
    return Status::Ok();
  }

  Status TimedOut() {
    ++past_.timeouts;
    return {StatusKind::kUnavailable, "frame_timeout", "the camera has sent no frame in time"};
  }

  Result<RawFrame> Copy(ArvBuffer* buffer) {
    if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) {
      return Status(StatusKind::kUnavailable, "frame_incomplete", "packets of a frame were lost for good");
    }
    DRUPE_ASSIGN_OR_RETURN(const FrameLayout layout, LayoutOf(arv_buffer_get_image_pixel_format(buffer)));
    RawFrame frame;
    frame.layout = layout;
    frame.width = arv_buffer_get_image_width(buffer);
    frame.height = arv_buffer_get_image_height(buffer);
    frame.id = arv_buffer_get_frame_id(buffer);
    frame.exposed = clock_.ExposedAt(arv_buffer_get_timestamp(buffer), ReceivedAt(buffer));
    std::size_t size = 0;
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
    const std::size_t expected = std::size_t(frame.width) * frame.height * (layout == FrameLayout::kRgb ? 3 : 1);
    if (data == nullptr || size < expected) return Internal("bad_frame", "a frame is shorter than its size says");
    frame.bytes.assign(data, data + expected);
    return frame;
  }

  const GObjectPointer<ArvCamera> camera_;
  const CameraOptions options_;
  CameraIdentity identity_;
  ShutterClock clock_;
  int width_ = 0, height_ = 0;
  std::atomic<bool> lost_{false};
  CameraCounters past_;  ///< of streams that have ended, and what Aravis does not count
  GObjectPointer<ArvStream> stream_;
};

}  // namespace

Result<std::unique_ptr<Camera>> Camera::Open(const std::string& id, const CameraOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  AravisError error;
  if (id.empty()) arv_update_device_list();  // a camera that is named is looked for by name
  GObjectPointer<ArvCamera> camera(arv_camera_new(id.empty() ? nullptr : id.c_str(), error.out()));
  const Status opened = error.Take("opening the camera");
  if (opened.code() == "camera_busy" || opened.code() == "camera_lost") return opened;
  if (!opened.ok() || !camera) {
    return NotFound("camera_not_found", "there is no camera " + (id.empty() ? "on this machine's networks" : id),
                    "camera");
  }
  auto opened_camera = std::make_unique<AravisCamera>(std::move(camera), options);
  DRUPE_RETURN_IF_ERROR(opened_camera->Configure());
  return std::unique_ptr<Camera>(std::move(opened_camera));
}

}  // namespace drupe
