#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/board/board_print.h"

namespace drupe {
namespace {

constexpr double kMmPerInch = 25.4;
constexpr double kMaxDots = 400e6;

/// Ink adds up, so that cells that share a dot leave no seam.
void AddInk(uchar& dot, double share, int grey) {
  const long ink = std::lround((255 - grey) * std::clamp(share, 0.0, 1.0));
  dot = static_cast<uchar>(std::max(0L, dot - ink));
}

/// How much of dot [i, i + 1] the interval [from, to] covers.
double Overlap(int i, double from, double to) {
  return std::max(0.0, std::min(i + 1.0, to) - std::max<double>(i, from));
}

/// A page of dots; shapes come in dots.
class Canvas {
 public:
  Canvas(int width, int height) : dots_(height, width, CV_8U, cv::Scalar(255)) {}

  void Fill(const Rectangle& r) {
    const auto [x0, x1] = Span(r.x, r.x + r.width, dots_.cols);
    const auto [y0, y1] = Span(r.y, r.y + r.height, dots_.rows);
    for (int y = y0; y < y1; ++y) {
      const double share = Overlap(y, r.y, r.y + r.height);
      for (int x = x0; x < x1; ++x) {
        AddInk(dots_.at<uchar>(y, x), share * Overlap(x, r.x, r.x + r.width), 0);
      }
    }
  }

  void Fill(const Disc& disc) {
    const auto [x0, x1] = Span(disc.x - disc.radius - 1, disc.x + disc.radius + 1, dots_.cols);
    const auto [y0, y1] = Span(disc.y - disc.radius - 1, disc.y + disc.radius + 1, dots_.rows);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const double inside = disc.radius - std::hypot(x + 0.5 - disc.x, y + 0.5 - disc.y);
        AddInk(dots_.at<uchar>(y, x), inside + 0.5, disc.grey);
      }
    }
  }

  void Write(const Label& label) {
    constexpr double kHersheyCapitals = 21;  // dots high at scale 1
    const double scale = label.height_mm / kHersheyCapitals;
    const int thickness = std::max(1, static_cast<int>(label.height_mm / 9));
    cv::putText(dots_, label.text, cv::Point(cvRound(label.x), cvRound(label.y)), cv::FONT_HERSHEY_SIMPLEX, scale,
                cv::Scalar(0), thickness, cv::LINE_AA);
  }

  std::string Encode() const {
    std::vector<uchar> bytes;
    cv::imencode(".png", dots_, bytes);
    return {bytes.begin(), bytes.end()};
  }

 private:
  static std::pair<int, int> Span(double from, double to, int size) {
    return {std::clamp(static_cast<int>(std::floor(from)), 0, size),
            std::clamp(static_cast<int>(std::ceil(to)), 0, size)};
  }

  cv::Mat dots_;
};

std::string Big32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

/// The checksum of PNG chunks (PNG, 2nd edition, annex D).
std::uint32_t Crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

/// Adds the pHYs chunk, without which a printer would not know the size.
std::string WithResolution(std::string png, double dpi) {
  constexpr std::size_t kAfterHeader = 8 + 25;
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / kMmPerInch * 1000));
  const std::string chunk = "pHYs" + Big32(per_metre) + Big32(per_metre) + '\x01';
  return png.insert(kAfterHeader, Big32(9) + chunk + Big32(Crc32(chunk)));
}

std::string Render(const BoardDrawing& drawing, double dots_per_mm) {
  const double s = dots_per_mm;
  Canvas canvas(static_cast<int>(std::ceil(drawing.width_mm * s)), static_cast<int>(std::ceil(drawing.height_mm * s)));
  for (const Disc& disc : drawing.discs) canvas.Fill(Disc{disc.x * s, disc.y * s, disc.radius * s, disc.grey});
  for (const Rectangle& r : drawing.rectangles) {
    canvas.Fill(Rectangle{r.x * s, r.y * s, r.width * s, r.height * s});
  }
  for (const Label& label : drawing.labels) {
    canvas.Write({label.x * s, label.y * s, label.height_mm * s, label.text});
  }
  return canvas.Encode();
}

}  // namespace

Result<std::string> ToPng(const BoardDrawing& drawing, double dpi) {
  if (!(dpi >= 72 && dpi <= 2400)) return InvalidArgument("invalid_option", "must be 72 to 2400", "dpi");
  const double dots_per_mm = dpi / kMmPerInch;
  if (drawing.width_mm * drawing.height_mm * dots_per_mm * dots_per_mm > kMaxDots) {
    return Status(StatusKind::kTooLarge, "image_too_large",
                  "the picture would have more than 400 million dots; choose a lower dpi", "dpi");
  }
  try {
    return WithResolution(Render(drawing, dots_per_mm), dpi);
  } catch (const std::exception& error) {
    return Internal("board_drawing_failed", error.what());
  }
}

}  // namespace drupe
