#pragma once

#include <optional>

#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// Whether a patch is drawn on the skin as a stain is, and not laid over it by light: one roundish outline of at least
/// `min_area` mm2 at the level `level`, which the colour crosses within a few tenths of a millimetre all around, from
/// skin that is clear of it to a defect that is even. A highlight, a reflection and shade fade out over a millimetre or
/// more, or end on one side only, whatever their colour; so this tells a pale spot on grey skin from gloss where the
/// colours are the same.
bool HasStainsEdge(const TransitionField& field, double level, double min_area);

/// Whether the field falls about as steeply all along the outline at `level`, as the edge of pigment does, which the
/// lens alone has blurred: nowhere less than half as steeply as at most places.
bool HasEvenEdge(const TransitionField& field, double level, double min_area);

/// Over how many mm the field would fall from 1 to 0 at its slope at `level`, the median along the largest outline,
/// without what the resampling's kernel adds; nothing where there is no outline of `min_area` mm2.
std::optional<double> EdgeWidth(const TransitionField& field, double level, double min_area);

}  // namespace drupe
