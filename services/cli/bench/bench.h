#pragma once

#include <string>

#include "base/status.h"

namespace CLI {
class App;
}

namespace drupe {

/// `drupe bench NAME ...`: each function adds one measurement to the command `bench`; it prints a table of figures and
/// leaves its result in `exit_code` (0 done, 1 the work failed). Files are named bench_<name>.cpp.

/// `bench defects`: found, false, class, grade, areas and their uncertainties.
void AddDefectsBench(CLI::App& bench, int& exit_code);

/// `bench contour`: contours and areas by sampling density (paper Table 5).
void AddContourBench(CLI::App& bench, int& exit_code);

/// `bench segmentation`: ours, K-means and K-means++ on the same points (paper 4.3 (1)).
void AddSegmentationBench(CLI::App& bench, int& exit_code);

/// `bench background`: fruit against background by colour (paper Table 4).
void AddBackgroundBench(CLI::App& bench, int& exit_code);

/// `bench dense`: cost and error of the dense cloud (paper Table 3), beside pmvs2.
void AddDenseBench(CLI::App& bench, int& exit_code);

/// `bench matching`: matches and wrong ones by ratio threshold (paper Table 1).
void AddMatchingBench(CLI::App& bench, int& exit_code);

/// `bench bayer`: what a camera's Bayer frames cost in the accuracy of poses.
void AddBayerBench(CLI::App& bench, int& exit_code);

/// `bench sfm`: cost and errors of structure from motion (paper Table 2), beside COLMAP.
void AddSfmBench(CLI::App& bench, int& exit_code);

/// Prints the message of a failed bench to stderr; the exit code for it.
int BenchExitCode(const Status& status);

}  // namespace drupe
