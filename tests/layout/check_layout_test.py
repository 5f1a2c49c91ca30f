#!/usr/bin/env python3
"""Feeds check_layout.py trees with one wrong include each and sees it fail, and a right one and sees it pass."""
import pathlib
import tempfile
import unittest

import check_layout

GOOD_TREE = {
    "README.md": "",
    ".git/config": "",
    "shared/base/status.h": "#pragma once\n#include <string>\n",
    "shared/base/version.h.in": "",
    "shared/geometry/sim3.h": '#include "base/status.h"\n#include "base/version.h"\n',
    "shared/image/image.h": "",
    "shared/scene/report.h": '#include "geometry/sim3.h"\n#include "image/image.h"\n',
    "shared/store/object_store.h": '#include "base/status.h"\n',
    "shared/jobs/job_store.h": '#include "base/status.h"\n',
    "shared/jobs/sqlite/sqlite_job_store.cpp": '#include <sqlite3.h>\n#include "jobs/job_store.h"\n',
    "shared/http/server.h": '#include "base/status.h"\n',
    "shared/service/stores.h": '#include "http/server.h"\n#include "jobs/job_store.h"\n',
    "services/reconstruction/features/sift.h": '#include "scene/report.h"\n',
    "services/reconstruction/dense/dense.h": "",
    "services/reconstruction/dense/dense.cpp": '#include "reconstruction/dense/dense.h"\n#include <opencv2/core.hpp>\n',
    "services/reconstruction/pipeline.h": '#include "reconstruction/features/sift.h"\n#include "store/object_store.h"\n',
    "services/reconstruction/routes.h": '#include "reconstruction/pipeline.h"\n#include "http/server.h"\n',
    "services/reconstruction/main.cpp": '#include "reconstruction/routes.h"\n',
    "services/reconstruction/routes_test.cpp": '#include "reconstruction/routes.h"\n',
    "services/defect_analysis/fruit/fruit.h": "",
    "services/cli/run_command.cpp": '#include "reconstruction/pipeline.h"\n#include "defect_analysis/fruit/fruit.h"\n',
}

BAD_INCLUDES = [  # (file, include)
    ("shared/base/status.h", "geometry/sim3.h"),
    ("shared/geometry/sim3.h", "image/image.h"),
    ("shared/image/image.h", "scene/report.h"),
    ("shared/scene/report.h", "store/object_store.h"),
    ("shared/scene/report.h", "reconstruction/features/sift.h"),
    ("shared/store/object_store.h", "jobs/job_store.h"),
    ("shared/http/server.h", "scene/report.h"),
    ("shared/http/server.h", "service/stores.h"),
    ("shared/service/stores.h", "scene/report.h"),
    ("services/reconstruction/features/sift.h", "reconstruction/dense/dense.h"),
    ("services/reconstruction/features/sift.h", "reconstruction/pipeline.h"),
    ("services/reconstruction/features/sift.h", "http/server.h"),
    ("services/reconstruction/dense/dense.cpp", "jobs/job_store.h"),
    ("services/reconstruction/pipeline.h", "reconstruction/routes.h"),
    ("services/reconstruction/pipeline.h", "defect_analysis/fruit/fruit.h"),
    ("services/reconstruction/main.cpp", "defect_analysis/fruit/fruit.h"),
    ("services/cli/run_command.cpp", "reconstruction/routes.h"),
    ("services/cli/run_command.cpp", "http/server.h"),
    ("services/reconstruction/pipeline.h", "../shared/store/object_store.h"),
    ("services/reconstruction/pipeline.h", "pipeline_options.h"),
]


def problems_of(tree):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in tree.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        return check_layout.check(root)


class CheckLayoutTest(unittest.TestCase):
    def test_good_tree_passes(self):
        self.assertEqual(problems_of(GOOD_TREE), [])

    def test_every_wrong_include_is_found_and_named(self):
        for source, target in BAD_INCLUDES:
            with self.subTest(source=source, target=target):
                tree = dict(GOOD_TREE)
                tree[source] += f'#include "{target}"\n'
                line = tree[source].count("\n")
                problems = problems_of(tree)
                self.assertEqual(len(problems), 1, problems)
                self.assertTrue(problems[0].startswith(f"{source}:{line}: "), problems[0])

    def test_slow_header_in_a_header_is_found(self):
        for header in ("opencv2/core.hpp", "pcl/point_cloud.h", "httplib.h", "spdlog/spdlog.h", "ceres/ceres.h"):
            with self.subTest(header=header):
                tree = dict(GOOD_TREE, **{"services/reconstruction/dense/dense.h": f"#include <{header}>\n"})
                self.assertEqual(len(problems_of(tree)), 1)

    def test_unknown_top_level_entry_is_found(self):
        self.assertEqual(problems_of(dict(GOOD_TREE, **{"scripts/run": ""})), ["scripts: not on the list of the top level"])

    def test_shared_folder_without_a_layer_is_found(self):
        self.assertEqual(len(problems_of(dict(GOOD_TREE, **{"shared/util/misc.h": ""}))), 1)


if __name__ == "__main__":
    unittest.main()
