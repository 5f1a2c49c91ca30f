#include "defect_analysis/models/train_class_model.h"

#include <algorithm>
#include <cmath>

#include "base/ids.h"
#include "geometry/positive_solve.h"

namespace drupe {
namespace {

using Defects = std::vector<LabelledDefect>;

constexpr int kMaxSteps = 100;        // of Newton; some ten are usual
constexpr int kMaxHalvings = 40;      // of one step
constexpr double kGradient = 1e-9;    // a defect, at which the best model is reached
constexpr double kLeastScale = 0.02;  // of a feature: what varies less is noise
constexpr double kBiasRidge = 1e-3;   // as a share of the ridge: enough to make the best bias one

// Penalised negative log-likelihood of weights and bias (classes x features + 1), to be minimised.
class Likelihood {
 public:
  Likelihood(Eigen::MatrixXd inputs, std::vector<int> labels, int classes, double ridge)
      : inputs_(std::move(inputs)), labels_(std::move(labels)), classes_(classes) {
    penalty_.setConstant(inputs_.cols(), ridge);
    penalty_[inputs_.cols() - 1] *= kBiasRidge;
  }

  double Value(const Eigen::MatrixXd& weights) const {
    double value = 0.5 * (weights.array().square().rowwise() * penalty_.transpose().array()).sum();
    const Eigen::MatrixXd scores = inputs_ * weights.transpose();
    for (Eigen::Index i = 0; i < scores.rows(); ++i) {
      const double most = scores.row(i).maxCoeff();
      value += most + std::log((scores.row(i).array() - most).exp().sum()) - scores(i, labels_[i]);
    }
    return value;
  }

  // Gradient and Hessian, the classes' rows one after the other.
  void Derive(const Eigen::MatrixXd& weights, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
    const Eigen::Index n = inputs_.cols();
    gradient.resize(classes_ * n);
    hessian.setZero(classes_ * n, classes_ * n);
    const Eigen::MatrixXd probabilities = Probabilities(weights);
    for (int a = 0; a < classes_; ++a) {
      Eigen::VectorXd excess = probabilities.col(a);
      for (Eigen::Index i = 0; i < excess.size(); ++i) excess[i] -= labels_[i] == a ? 1 : 0;
      gradient.segment(a * n, n) =
          inputs_.transpose() * excess + penalty_.cwiseProduct(weights.row(a).transpose().eval());
      for (int b = 0; b < classes_; ++b) {
        const Eigen::VectorXd curvature =
            probabilities.col(a).array() * ((a == b ? 1.0 : 0.0) - probabilities.col(b).array());
        const Eigen::MatrixXd curved = curvature.asDiagonal() * inputs_;
        hessian.block(a * n, b * n, n, n).noalias() = inputs_.transpose() * curved;
      }
      hessian.diagonal().segment(a * n, n) += penalty_;
    }
  }

  Eigen::Index size() const { return inputs_.rows(); }

 private:
  Eigen::MatrixXd Probabilities(const Eigen::MatrixXd& weights) const {
    const Eigen::MatrixXd scores = inputs_ * weights.transpose();
    const Eigen::VectorXd most = scores.rowwise().maxCoeff();
    const Eigen::ArrayXXd odds = (scores.colwise() - most).array().exp();
    const Eigen::ArrayXd sums = odds.rowwise().sum();
    return (odds.colwise() / sums).matrix();
  }

  Eigen::MatrixXd inputs_;   // one row a defect: standardised features, then 1
  std::vector<int> labels_;  // places among the classes
  int classes_;
  Eigen::VectorXd penalty_;
};

// Newton's method, each step halved until it gains.
Eigen::MatrixXd Maximise(const Likelihood& likelihood, int classes) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(classes, kClassFeatures + 1);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  double value = likelihood.Value(weights);
  for (int step = 0; step < kMaxSteps; ++step) {
    likelihood.Derive(weights, gradient, hessian);
    if (gradient.lpNorm<Eigen::Infinity>() <= kGradient * static_cast<double>(likelihood.size())) break;
    if (!FactorPositive(hessian)) break;
    Eigen::VectorXd move = -gradient;
    SolveFactored(hessian, move);
    const Eigen::MatrixXd rows = move.reshaped<Eigen::RowMajor>(classes, kClassFeatures + 1);
    double length = 1;
    int halvings = 0;
    while (halvings < kMaxHalvings && !(likelihood.Value(weights + length * rows) < value)) {
      length /= 2;
      ++halvings;
    }
    if (halvings == kMaxHalvings) break;  // nothing left to gain in double precision
    weights += length * rows;
    value = likelihood.Value(weights);
  }
  return weights;
}

std::vector<DefectClass> ClassesOf(const Defects& defects) {
  std::vector<DefectClass> classes;
  for (const LabelledDefect& defect : defects) classes.push_back(defect.defect_class);
  std::sort(classes.begin(), classes.end());
  classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
  return classes;
}

int PlaceOf(const std::vector<DefectClass>& classes, DefectClass defect_class) {
  return static_cast<int>(std::find(classes.begin(), classes.end(), defect_class) - classes.begin());
}

void Standardise(const Defects& defects, ClassModel& model) {
  const auto count = static_cast<double>(defects.size());
  ClassFeatures variance = ClassFeatures::Zero();
  for (const LabelledDefect& defect : defects) model.mean += defect.features / count;
  for (const LabelledDefect& defect : defects) variance += (defect.features - model.mean).cwiseAbs2() / count;
  model.scale = variance.cwiseSqrt().cwiseMax(kLeastScale);
}

Status CheckDefects(const Defects& defects, const std::vector<DefectClass>& classes) {
  if (defects.empty()) return Unprocessable("no_defects", "the reports have no defects to learn from");
  if (classes.size() < 2) {
    return Unprocessable("one_class", std::string("all defects are of the class ") + DefectClassName(classes.front()) +
                                          ": at least two classes are needed");
  }
  const auto finite = [](const LabelledDefect& defect) { return defect.features.allFinite(); };
  if (!std::all_of(defects.begin(), defects.end(), finite)) {
    return Unprocessable("training_failed", "a defect's features are not finite");
  }
  return Status::Ok();
}

Result<ClassModel> Fit(const Defects& defects, double ridge) {
  ClassModel model;
  model.classes = ClassesOf(defects);
  DRUPE_RETURN_IF_ERROR(CheckDefects(defects, model.classes));
  Standardise(defects, model);
  const int classes = static_cast<int>(model.classes.size());
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(defects.size()), kClassFeatures + 1);
  std::vector<int> labels;
  for (const LabelledDefect& defect : defects) {
    inputs.row(static_cast<Eigen::Index>(labels.size())).head<kClassFeatures>() =
        (defect.features - model.mean).cwiseQuotient(model.scale);
    labels.push_back(PlaceOf(model.classes, defect.defect_class));
  }
  const Eigen::MatrixXd weights = Maximise(Likelihood(std::move(inputs), std::move(labels), classes, ridge), classes);
  model.weights = weights.leftCols<kClassFeatures>();
  model.bias = weights.col(kClassFeatures);
  return model;
}

Defects Join(const std::vector<Defects>& reports, std::size_t without) {
  Defects all;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    if (k != without) all.insert(all.end(), reports[k].begin(), reports[k].end());
  }
  return all;
}

// `classes` orders the table; `model` may know fewer.
void Judge(const ClassModel& model, const Defects& defects, const std::vector<DefectClass>& classes,
           ClassConfusion& table) {
  for (const LabelledDefect& defect : defects) {
    const DefectClass found = model.Classify(defect.features).defect_class;
    ++table(PlaceOf(classes, defect.defect_class), PlaceOf(classes, found));
  }
}

}  // namespace

Status ClassTrainOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(CheckImageName(name));
  if (ridge >= 0.001 && ridge <= 1000) return Status::Ok();
  return InvalidArgument("invalid_option", "ridge must be 0.001 to 1000", "ridge");
}

Result<ClassModel> TrainClassModel(const std::vector<Defects>& reports, const ClassTrainOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  const Defects all = Join(reports, reports.size());
  DRUPE_ASSIGN_OR_RETURN(ClassModel model, Fit(all, options.ridge));
  model.name = options.name;
  model.ridge = options.ridge;
  model.reports = static_cast<std::int64_t>(reports.size());
  const auto classes = static_cast<Eigen::Index>(model.classes.size());
  model.training = model.left_out = ClassConfusion::Zero(classes, classes);
  Judge(model, all, model.classes, model.training);
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const Result<ClassModel> others = Fit(Join(reports, k), options.ridge);
    if (others.ok()) Judge(*others, reports[k], model.classes, model.left_out);  // else the others have one class only
  }
  return model;
}

}  // namespace drupe
