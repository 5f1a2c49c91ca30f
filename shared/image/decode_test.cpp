#include "image/decode.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

namespace drupe {
namespace {

using namespace std::string_literals;

/// A smooth coloured picture with some texture, BGR.
cv::Mat Picture(int width, int height) {
  cv::Mat picture(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<uchar>(x * 255 / width), static_cast<uchar>(y * 255 / height),
                                              static_cast<uchar>((x * y / 7) % 128 + 64));
    }
  }
  return picture;
}

std::string Encode(const cv::Mat& picture, const std::string& extension, const std::vector<int>& parameters = {}) {
  std::vector<uchar> bytes;
  EXPECT_TRUE(cv::imencode(extension, picture, bytes, parameters));
  return {bytes.begin(), bytes.end()};
}

std::string Big32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

std::uint32_t Crc32(const std::string& text) {
  std::uint32_t crc = ~0U;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

/// The PNG with another size in its header and a correct checksum.
std::string PngClaiming(std::string png, std::uint32_t width, std::uint32_t height) {
  png.replace(16, 8, Big32(width) + Big32(height));
  png.replace(29, 4, Big32(Crc32(png.substr(12, 17))));
  return png;
}

/// Position of the height in a JPEG's frame header.
std::size_t JpegHeightAt(const std::string& jpeg) {
  return jpeg.find("\xFF\xC0\x00\x11\x08"s) + 5;
}

std::string Code(const Status& status) {
  return status.ok() ? "ok" : status.code();
}

/// A little-endian directory entry.
std::string Entry(int tag, int type, std::uint32_t value) {
  const auto little = [](std::uint32_t v, int bytes) {
    std::string out;
    for (int i = 0; i < bytes; ++i) out += static_cast<char>(v >> (8 * i));
    return out;
  };
  return little(tag, 2) + little(type, 2) + little(1, 4) + little(value, 4);
}

/// EXIF with orientation 6 and FocalLengthIn35mmFilm.
std::string ExifSegment(int focal_35mm) {
  const std::string tiff = "II*\0\x08\0\0\0"s + "\x02\0"s + Entry(0x0112, 3, 6) + Entry(0x8769, 4, 38) + "\0\0\0\0"s +
                           "\x01\0"s + Entry(0xA405, 3, focal_35mm) + "\0\0\0\0"s;
  const std::string content = "Exif\0\0"s + tiff;
  const auto length = static_cast<std::uint16_t>(content.size() + 2);
  return "\xFF\xE1"s + static_cast<char>(length >> 8) + static_cast<char>(length & 0xFF) + content;
}

std::string WithExif(std::string jpeg, const std::string& segment) {
  return jpeg.insert(2, segment);
}

struct Format {
  const char* extension;
  ImageFormat format;
};
constexpr Format kFormats[] = {{".jpg", ImageFormat::kJpeg}, {".png", ImageFormat::kPng}, {".tif", ImageFormat::kTiff}};

TEST(DecodeTest, ReadsEveryFormat) {
  const cv::Mat picture = Picture(97, 61);
  cv::Mat luma;
  cv::cvtColor(picture, luma, cv::COLOR_BGR2GRAY);
  for (const Format& format : kFormats) {
    const std::string bytes = Encode(picture, format.extension, {cv::IMWRITE_JPEG_QUALITY, 100});
    const auto info = VerifyImage(bytes);
    ASSERT_TRUE(info.ok()) << info.status().ToString();
    EXPECT_EQ(info->format, format.format);
    EXPECT_EQ(info->width, 97);
    EXPECT_EQ(info->height, 61);
    const auto rgb = DecodeRgb(bytes);
    const auto gray = DecodeGray(bytes);
    ASSERT_TRUE(rgb.ok() && gray.ok());
    const int tolerance = format.format == ImageFormat::kJpeg ? 12 : 1;
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(96, 60), std::pair(50, 20)}) {
      const cv::Vec3b bgr = picture.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb->At(x, y, c), bgr[2 - c], tolerance) << format.extension;
      EXPECT_NEAR(gray->At(x, y), luma.at<uchar>(y, x), tolerance) << format.extension;
    }
  }
}

TEST(DecodeTest, Reduces16BitTo8) {
  cv::Mat deep;
  Picture(40, 30).convertTo(deep, CV_16U, 257);
  for (const char* extension : {".png", ".tif"}) {
    for (const bool colour : {true, false}) {
      cv::Mat picture = deep;
      if (!colour) cv::extractChannel(deep, picture, 1);
      const auto gray = DecodeGray(Encode(picture, extension));
      const auto rgb = DecodeRgb(Encode(picture, extension));
      ASSERT_TRUE(gray.ok() && rgb.ok()) << gray.status().ToString();
      EXPECT_NEAR(rgb->At(20, 15, 1), 15 * 255 / 30, 1) << extension;
      if (!colour) {
        EXPECT_NEAR(gray->At(20, 15), 15 * 255 / 30, 1) << extension;
      }
    }
  }
}

TEST(DecodeTest, IgnoresExifRotationAndReadsItsFocalLength) {
  const std::string bytes = WithExif(Encode(Picture(360, 240), ".jpg"), ExifSegment(50));
  const auto info = ProbeImage(bytes);
  ASSERT_TRUE(info.ok());
  EXPECT_NEAR(info->exif_focal_px, 500, 1e-9);  // 50 mm before a frame of 36 mm
  const auto gray = DecodeGray(bytes);
  ASSERT_TRUE(gray.ok());
  EXPECT_EQ(gray->width(), 360);
  EXPECT_EQ(gray->height(), 240);
}

TEST(DecodeTest, HostileExifNeverStopsAPicture) {
  const std::string jpeg = Encode(Picture(64, 48), ".jpg");
  const std::string good = ExifSegment(35);
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    std::string segment = good;
    for (int k = 0; k < 3; ++k) segment[10 + random() % (segment.size() - 10)] = static_cast<char>(random());
    const auto info = ProbeImage(WithExif(jpeg, segment));
    ASSERT_TRUE(info.ok());
    EXPECT_TRUE(info->exif_focal_px == 0 || (info->exif_focal_px > 12 && info->exif_focal_px < 6400));
  }
}

TEST(DecodeTest, RefusesOtherFormats) {
  EXPECT_EQ(Code(VerifyImage("GIF89a\x01\0\x01\0"s).status()), "unsupported_image");
  EXPECT_EQ(Code(VerifyImage(Encode(Picture(8, 8), ".bmp")).status()), "unsupported_image");
  EXPECT_EQ(Code(VerifyImage("\x76\x2f\x31\x01\x02\0\0\0"s).status()), "unsupported_image");  // OpenEXR
  EXPECT_EQ(Code(VerifyImage("<svg/>").status()), "unsupported_image");
  EXPECT_EQ(VerifyImage("GIF89a").status().kind(), StatusKind::kUnsupportedMedia);
  EXPECT_EQ(Code(VerifyImage("").status()), "bad_image");
}

TEST(DecodeTest, RefusesTruncationAnywhere) {
  for (const Format& format : kFormats) {
    const std::string bytes = Encode(Picture(80, 60), format.extension);
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 300);
    for (std::size_t size = 16; size < bytes.size(); size += step) {
      EXPECT_EQ(Code(VerifyImage(bytes.substr(0, size)).status()), "bad_image") << format.extension << " " << size;
    }
    // The last bytes: JPEG's end marker, PNG's end chunk, TIFF's directory.
    for (std::size_t missing = 1; missing <= 2; ++missing) {
      EXPECT_EQ(Code(VerifyImage(bytes.substr(0, bytes.size() - missing)).status()), "bad_image") << format.extension;
    }
  }
}

TEST(DecodeTest, RefusesBombsBeforeDecoding) {
  const std::string png = Encode(Picture(64, 64), ".png");
  EXPECT_EQ(Code(VerifyImage(PngClaiming(png, 30000, 30000)).status()), "image_too_large");
  EXPECT_EQ(Code(VerifyImage(PngClaiming(png, 16384, 16384)).status()), "image_too_large");
  EXPECT_EQ(Code(VerifyImage(PngClaiming(png, 0xFFFFFFFF, 1)).status()), "image_too_large");
  EXPECT_EQ(Code(VerifyImage(PngClaiming(png, 0, 64)).status()), "bad_image");
  std::string jpeg = Encode(Picture(64, 64), ".jpg");
  jpeg.replace(JpegHeightAt(jpeg), 4, "\xFF\xFF\xFF\xFF");
  EXPECT_EQ(Code(VerifyImage(jpeg).status()), "image_too_large");
  Limits limits;
  limits.max_image_bytes = png.size() - 1;
  EXPECT_EQ(VerifyImage(png, limits).status().kind(), StatusKind::kTooLarge);
}

TEST(DecodeTest, RefusesPixelsThatDoNotFillTheSize) {
  EXPECT_EQ(Code(VerifyImage(PngClaiming(Encode(Picture(64, 64), ".png"), 64, 640)).status()), "bad_image");
  std::string jpeg = Encode(Picture(64, 64), ".jpg");
  jpeg.replace(JpegHeightAt(jpeg), 2, "\x02\x80"s);
  EXPECT_EQ(Code(VerifyImage(jpeg).status()), "bad_image");
}

TEST(DecodeTest, DamagedFilesGiveAPictureOfTheStatedSizeOrAnError) {
  std::mt19937 random(11);
  for (const Format& format : kFormats) {
    const std::string good = Encode(Picture(48, 36), format.extension);
    Limits limits;
    limits.max_image_pixels = 200'000;  // keeps files whose size was hit quick
    for (int i = 0; i < 1500; ++i) {
      std::string bytes = good;
      for (int k = 0; k < 1 + i % 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      const auto image = DecodeRgb(bytes, limits);
      if (!image.ok()) continue;
      const auto info = ProbeImage(bytes, limits);
      ASSERT_TRUE(info.ok());
      EXPECT_EQ(image->width(), info->width);
      EXPECT_EQ(image->height(), info->height);
    }
  }
}

}  // namespace
}  // namespace drupe
