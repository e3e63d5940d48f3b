#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-includes finds each kind of planted violation, and nothing in a clean tree."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).parents[2] / "tools/ci/check-includes"
SPDX = ("// SPDX-FileCopyrightText: 2026 the psfm authors\n"
        "// SPDX-License-Identifier: BSD-3-Clause\n")
TABLE = """# from bottom to top
stages/features:
stages/clustering:  stages/features
stages/merge:       stages/features
storage:
scheduler:
tools/commands:
"""


class CheckIncludes(unittest.TestCase):
    THERE = "docs/there" + ".md"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("tools/ci/folders.txt", TABLE, head="")
        for folder in ("graph", "storage", "stages/features", "stages/clustering", "scheduler", "tools/commands"):
            self.write(f"{folder}/README.md", "# What belongs here\n", head="")
        self.write("stages/merge/README.md", "# Merging\n\n`deep/` is below it.\n", head="")
        self.write("graph/ids.h", "#pragma once\n#include <vector>\n")
        self.write("storage/store.h", '#pragma once\n#include "graph/ids.h"\n')
        self.write("stages/merge/merge.h", '#pragma once\n#include "graph/ids.h"\n')
        self.write("stages/clustering/state.h", "#pragma once\n")
        self.write("stages/features/sift.cpp", "#include <opencv2/core.hpp>\n#include <tbb/parallel_for.h>\n")
        self.write("scheduler/flow.cpp", '#include <tbb/flow_graph.h>\n#include "storage/store.h"\n')

    def write(self, path, body, head=SPDX):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(head + body)

    def run_check(self):
        done = subprocess.run([sys.executable, CHECK, self.root], capture_output=True, text=True)
        return done.returncode, done.stdout

    def assert_found(self, path, body, words, head=SPDX):
        self.write(path, body, head)
        code, output = self.run_check()
        self.assertEqual(code, 1, output)
        findings = output.strip().splitlines()
        self.assertEqual(len(findings), 1, output)
        self.assertTrue(findings[0].startswith(path + ":"), output)
        self.assertIn(words, findings[0])

    def test_clean_tree(self):
        code, output = self.run_check()
        self.assertEqual(code, 0, output)

    def test_python_parses(self):
        head = SPDX.replace("//", "#")
        broken = "def main():\n    if True:\n    return 1\n"
        self.assert_found("tools/bench/a.py", broken, "is no Python", head)
        (self.root / "tools/bench/a.py").unlink()
        self.assert_found("tools/fuzz", broken, "is no Python", "#!/usr/bin/env python3\n" + head)
        self.write("tools/fuzz", "def main():\n    return 1\n", "#!/usr/bin/env python3\n" + head)
        self.write("tools/test", "if; then\n", "#!/usr/bin/env bash\n" + head)
        self.assertEqual(self.run_check()[0], 0)

    def test_the_top_level_is_agreed(self):
        for allowed in ("README.md", ".clang-format", "build/psfm"):
            self.write(allowed, "", head="")
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("psfm", "", "no place at the top level", head="")

    def test_every_test_is_built(self):
        self.assert_found("tests/stages/a_test.cpp", "", "is never built")
        self.write("tests/stages/CMakeLists.txt", "psfm_add_test(a SOURCES a_test.cpp)\n", SPDX.replace("//", "#"))
        self.assertEqual(self.run_check()[0], 0)

    def test_graph_includes_nobody(self):
        self.assert_found("graph/a.cpp", '#include "storage/store.h"\n', "may not include storage/")

    def test_storage_knows_no_stage(self):
        self.assert_found("storage/a.cpp", '#include "stages/merge/merge.h"\n', "may not include stages/")

    def test_only_simulate_includes_generators(self):
        self.write("tests/synthetic/scene.h", "#pragma once\n")
        self.write("tests/other/scene.h", "#pragma once\n")
        self.write("tools/commands/simulate_command.cpp", '#include "tests/synthetic/scene.h"\n')
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("tools/commands/run_command.cpp", '#include "tests/synthetic/scene.h"\n',
                          "may not include tests/")
        self.write("tools/commands/run_command.cpp", "")
        self.assert_found("tools/commands/simulate_command.cpp", '#include "tests/other/scene.h"\n',
                          "may not include tests/")

    def test_stage_knows_no_store(self):
        self.assert_found("stages/merge/a.cpp", '#include "storage/store.h"\n', "may not include storage/")

    def test_stage_has_no_flow_graph(self):
        for header in ("tbb/flow_graph.h", "oneapi/tbb/flow_graph.h"):
            self.assert_found("stages/merge/a.cpp", f"#include <{header}>\n", "may not use tbb-flow")

    def test_graph_uses_no_library(self):
        self.assert_found("graph/a.h", "#pragma once\n#include <ceres/ceres.h>\n", "may not use ceres")

    def test_siblings_as_the_table_says(self):
        self.write("stages/features/sift.h", "#pragma once\n")
        self.write("stages/clustering/b.cpp", '#include "stages/features/sift.h"\n')
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("stages/clustering/a.cpp", '#include "stages/merge/merge.h"\n',
                          "stages/clustering/ may not include stages/merge/")

    def test_no_way_back(self):
        self.assert_found("stages/features/a.cpp", '#include "stages/merge/merge.h"\n',
                          "stages/features/ may not include stages/merge/")
        (self.root / "stages/features/a.cpp").unlink()
        names = TABLE.replace("stages/features:", "stages/features: stages/merge")
        self.assert_found("tools/ci/folders.txt", names, "names stages/merge/, which no line above is about", head="")

        self.write("tools/ci/folders.txt", TABLE, head="")
        self.assertEqual(self.run_check()[0], 0)

    def test_folders_of_a_folder(self):
        self.write("stages/merge/deep/deep.h", "#pragma once\n")
        self.assert_found("tools/ci/folders.txt", TABLE, "has no line for stages/merge/deep/", head="")
        below = TABLE.replace("stages/merge:       ", "stages/merge/deep:\nstages/merge:  stages/merge/deep ")
        self.write("tools/ci/folders.txt", below, head="")
        self.write("stages/merge/b.cpp", '#include "stages/merge/deep/deep.h"\n')
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("stages/merge/deep/a.cpp", '#include "stages/merge/merge.h"\n',
                          "stages/merge/deep/ may not include stages/merge/")

    def test_tools_below_each_other(self):
        self.write("tools/commands/README.md", "# Commands\n\n`console/` is below them.\n", head="")
        self.write("tools/commands/commands.h", "#pragma once\n")
        self.write("tools/commands/console/words.h", "#pragma once\n")
        below = "tools/commands/console:\ntools/commands: tools/commands/console\n"
        self.write("tools/ci/folders.txt", TABLE.replace("tools/commands:\n", below), head="")
        self.write("tools/commands/run.cpp", '#include "tools/commands/console/words.h"\n')
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("tools/commands/console/a.cpp", '#include "tools/commands/commands.h"\n',
                          "tools/commands/console/ may not include tools/commands/")

    def test_no_line_without_folder(self):
        self.assert_found("tools/ci/folders.txt", TABLE + "stages/gone:\n", "stages/gone/ is no folder", head="")

    def test_units_of_a_folder(self):
        for number in range(24):
            self.write(f"graph/unit{number}.h", "#pragma once\n")
            self.write(f"graph/unit{number}.cpp", "")
        self.write("graph/ids_kernel.cpp", "")  # with ids.h and the others: 26
        self.assertIn("graph:1: 26 units", self.run_check()[1])
        (self.root / "graph/unit0.h").unlink()
        (self.root / "graph/unit0.cpp").unlink()
        self.write("graph/ids_kernel_avx2.cpp", "")
        self.write("graph/ids_kernel_loop.h", "#pragma once\n")
        self.assertEqual(self.run_check()[0], 0)
        for number in range(26):
            self.write(f"tests/graph/unit{number}_test.cpp", "")
        self.assertIn("tests/graph:1: 26 units", self.run_check()[1])

    def test_only_paths_from_the_root(self):
        self.assert_found("graph/a.cpp", '#include "ids.h"\n', "include from the root")

    def test_licence(self):
        self.assert_found("graph/a.cpp", "", "SPDX", head="")

    def test_pragma_once(self):
        self.assert_found("graph/a.h", "", "#pragma once")

    def test_length(self):
        self.assert_found("graph/a.cpp", "\n" * 399, "split by concept")

    def test_no_printing(self):
        self.assert_found("scheduler/a.cpp", 'void f() { std::cout << "x"; }\n', "may not print")

    def test_mentioned_documents_are_there(self):
        gone = "GONE" + ".md"  # in two parts, or the check finds it here
        self.assert_found("graph/a.cpp", f"// As {gone} says.\n", f"{gone} is no document")
        self.write("graph/a.cpp", "// As docs/there" + ".md says, and there" + ".md.\n")
        self.write(self.THERE, "# There\n", head="")
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found(self.THERE, f"# There\n\nAs in [it](../docs/{gone}).\n", "is no document", head="")
        self.write(self.THERE, "# There\n", head="")
        self.write("CHANGELOG.md", f"{gone} is gone.\n", head="")
        self.write("docs/notebook/old" + ".md", f"{gone} was there.\n", head="")
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found("graph/a.cpp", "// As tools/there" + ".md says.\n", "is no document")

    def test_every_folder_says_what_belongs_there(self):
        self.write("tools/viewer/README.md", "# Pages\n\nIn `src/` are the sources.\n", head="")
        self.write("tools/viewer/src/viewer.ts", "")
        self.write("tools/report/README.md", "# Report\n", head="")
        self.write("tests/graph/here.h", "#pragma once\n")
        self.assertEqual(self.run_check()[0], 0)
        self.write("tools/report/plots/plot.h", "#pragma once\n")
        self.write("tools/ci/folders.txt", TABLE + "tools/report/plots:\n", head="")
        for above in ("# Report\n", "# Report\n\nThe plots are below.\n"):
            self.write("tools/report/README.md", above, head="")
            self.assertIn("tools/report/plots:1: no README.md", self.run_check()[1])
        self.write("tools/report/README.md", "# Report\n\nBelow: `plots`.\n", head="")
        self.assertEqual(self.run_check()[0], 0)
        self.write("README.md", "# psfm\n\nValues are in `graph/`.\n", head="")
        (self.root / "graph/README.md").unlink()
        self.assertIn("graph:1: no README.md", self.run_check()[1])

    def test_columns(self):
        wide = "word " * 24 + "s"
        self.write(self.THERE, f"# There\n\n{wide[:120]}\n|{wide} in a table|\n", head="")
        self.assertEqual(self.run_check()[0], 0)
        self.assert_found(self.THERE, f"# There\n\n{wide}\n", "121 columns", head="")
        self.write(self.THERE, "# There\n", head="")
        self.assert_found("docs/performance.md", f"# Written by a tool\n\n{wide}\n", "121 columns", head="")
        (self.root / "docs/performance.md").unlink()
        self.assert_found("graph/CMakeLists.txt", f"# {wide}\n", "123 columns")

    def test_empty_tree_is_no_success(self):
        with tempfile.TemporaryDirectory() as empty:
            self.root = Path(empty)
            self.assertEqual(self.run_check()[0], 1)


if __name__ == "__main__":
    unittest.main()
