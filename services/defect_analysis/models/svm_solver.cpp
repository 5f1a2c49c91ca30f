#include "defect_analysis/models/svm_solver.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>

namespace drupe {
namespace {

constexpr int kMaxIterations = 200'000;
constexpr double kTolerance = 1e-3;

cv::Mat RowsOf(const std::vector<Eigen::Vector3f>& points) {
  cv::Mat rows(static_cast<int>(points.size()), 3, CV_32F);
  for (int i = 0; i < rows.rows; ++i) {
    for (int axis = 0; axis < 3; ++axis) rows.at<float>(i, axis) = points[static_cast<std::size_t>(i)][axis];
  }
  return rows;
}

SvmSolution Extract(const cv::ml::SVM& svm) {
  SvmSolution solution;
  cv::Mat alpha, index;
  // OpenCV's sum is positive for the smaller label, which is the background's.
  solution.bias = static_cast<float>(svm.getDecisionFunction(0, alpha, index));
  const cv::Mat vectors = svm.getSupportVectors();
  for (int k = 0; k < static_cast<int>(alpha.total()); ++k) {
    const float* row = vectors.ptr<float>(index.at<int>(k));
    solution.vectors.emplace_back(row[0], row[1], row[2]);
    solution.weights.push_back(-static_cast<float>(alpha.at<double>(k)));
  }
  return solution;
}

}  // namespace

Result<SvmSolution> SolveSvm(const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint8_t>& labels,
                             double c, double gamma) {
  const auto fruit = std::count(labels.begin(), labels.end(), 1);
  if (fruit == 0 || fruit == static_cast<std::ptrdiff_t>(labels.size())) {
    return Unprocessable("one_class", "both fruit and background are needed for training");
  }
  try {
    const cv::Ptr<cv::ml::SVM> svm = cv::ml::SVM::create();
    svm->setType(cv::ml::SVM::C_SVC);
    svm->setKernel(cv::ml::SVM::RBF);
    svm->setC(c);
    svm->setGamma(gamma);
    svm->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, kMaxIterations, kTolerance});
    const std::vector<int> responses(labels.begin(), labels.end());
    if (!svm->train(RowsOf(points), cv::ml::ROW_SAMPLE, responses)) {
      return Unprocessable("training_failed", "no support vector machine fits the points");
    }
    return Extract(*svm);
  } catch (const cv::Exception& error) {
    return Unprocessable("training_failed", std::string("no support vector machine fits the points: ") + error.what());
  }
}

}  // namespace drupe
