#pragma once

#include <vector>

#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// The defects of one colour in a patch that holds two colours: how much of each node they cover, as a field whose
/// level runs from 0 to 1 and whose half-way line is their outline both towards the skin and towards the other colour.
struct ColourLayer {
  TransitionField field;
  std::vector<float> other;  ///< what the other layer covers of each node
};

/// Tells two touching defects of different colour apart (a rain spot on a crack's rim, say) by linear unmixing (Keshava
/// and Mustard 2002): in linear light a node's colour is the mean of the colours it covers, weighted by their shares,
/// so that skin, first and second colour are the corners of a triangle and a node's place in it gives the shares. The
/// first corner is the strongest colour of the patch, the second the one farthest from the line between it and the
/// skin, or else an even, fainter one on that line, which the first goes over into. Two layers come back, or none when
/// no colour of at least `min_area` mm2 lies farther from that line than noise and shading explain and none on it is
/// even, or when the two differ by less than `least_contrast` (weighted Lab, as the test of significance).
std::vector<ColourLayer> SeparateColours(const TransitionField& field, double level, double min_area,
                                         double least_contrast, double lightness_weight);

}  // namespace drupe
