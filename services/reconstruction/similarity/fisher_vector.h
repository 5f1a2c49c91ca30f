#pragma once

#include <Eigen/Core>

#include "reconstruction/similarity/gaussian_mixture.h"

namespace drupe {

/// The Fisher vector of a set of samples (paper eqs 1 and 3): the gradient of their mean log-likelihood with respect to
/// the mixture's weights, means and variances, each divided by the root of its Fisher information in closed form
/// (Sanchez, Perronnin, Mensink & Verbeek 2013, eqs 16-18), then power (signed square root) and L2 normalised. Length
/// K (1 + 2 D); zero for no samples.
Eigen::VectorXf FisherVector(const SampleMatrix& samples, const GaussianMixture& mixture);

}  // namespace drupe
