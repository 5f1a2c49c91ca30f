#pragma once

#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// Weighted colour difference between a defect's core and the skin about it that more light cannot explain. Gloss adds
/// the lamps' white to all three channels alike (Shafer's dichromatic reflection model, 1985), and skin that is lit
/// better than its surroundings is brighter by the same factor in all: where the core is brighter than the skin in that
/// way, the light is taken off first. What absorbs light in any channel, as a stain does, loses nothing.
double ContrastBeyondLight(const TransitionField& field, double lightness_weight);

/// Weighted colour difference between a defect's core and the skin about it, light included.
double Contrast(const TransitionField& field, double lightness_weight);

/// Whether a patch differs from the skin right beside it, and not only from the smooth model of the whole fruit's skin,
/// which is uncertain near the rim of what is seen: the local noise of the skin's colour leaves it local_sigma standard
/// deviations, and its contrast beyond light reaches `threshold`, or it stands out as a faint one does, or it is a
/// round, even spot with a border sharper than gloss can have.
bool StandsOut(const TransitionField& field, double threshold, const DefectOptions& options);

/// The same for a patch whose contrast, light included, reaches `threshold`: it must have a stain's edge, and where
/// light alone explains its colour but for a tint that lamps may have, the skin's own light must have changed, as
/// pigment changes it and gloss does not. One that is not roundish, as a scar, must have a sharp rim all along and a
/// colour that neither light nor shade gives the skin.
bool StandsOutFaintly(const TransitionField& field, double threshold, const DefectOptions& options);

/// The same for a contrast so low that only a sharp rim all along, of whatever form, tells a stain from uneven skin.
bool StandsOutByItsRim(const TransitionField& field, double threshold, const DefectOptions& options);

/// Whether a colour differs from the skin's by `threshold` or more, light included, and is one that neither light nor
/// shade gives the skin. Enough for what has a form of its own, as a crack that touches another defect.
bool HasColourOfItsOwn(const TransitionField& field, double threshold, const DefectOptions& options);

}  // namespace drupe
