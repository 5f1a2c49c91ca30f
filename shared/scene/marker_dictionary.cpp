#include "scene/marker_dictionary.h"

#include <array>

namespace drupe {
namespace {

constexpr std::array<MarkerDictionary, 21> kDictionaries{{
    {"DICT_4X4_50", 0, 4, 50},
    {"DICT_4X4_100", 1, 4, 100},
    {"DICT_4X4_250", 2, 4, 250},
    {"DICT_4X4_1000", 3, 4, 1000},
    {"DICT_5X5_50", 4, 5, 50},
    {"DICT_5X5_100", 5, 5, 100},
    {"DICT_5X5_250", 6, 5, 250},
    {"DICT_5X5_1000", 7, 5, 1000},
    {"DICT_6X6_50", 8, 6, 50},
    {"DICT_6X6_100", 9, 6, 100},
    {"DICT_6X6_250", 10, 6, 250},
    {"DICT_6X6_1000", 11, 6, 1000},
    {"DICT_7X7_50", 12, 7, 50},
    {"DICT_7X7_100", 13, 7, 100},
    {"DICT_7X7_250", 14, 7, 250},
    {"DICT_7X7_1000", 15, 7, 1000},
    {"DICT_ARUCO_ORIGINAL", 16, 5, 1024},
    {"DICT_APRILTAG_16h5", 17, 4, 30},
    {"DICT_APRILTAG_25h9", 18, 5, 35},
    {"DICT_APRILTAG_36h10", 19, 6, 2320},
    {"DICT_APRILTAG_36h11", 20, 6, 587},
}};

}  // namespace

const MarkerDictionary* FindMarkerDictionary(std::string_view name) {
  for (const MarkerDictionary& dictionary : kDictionaries) {
    if (dictionary.name == name) return &dictionary;
  }
  return nullptr;
}

}  // namespace drupe
