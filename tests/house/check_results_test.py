#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-results finds errors that are passed on in another way, and ones that nobody looks at."""
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

CHECK = Path(__file__).parents[2] / "tools/ci/check-results"


class CheckResults(unittest.TestCase):
    def run_check(self, body, name="stages/solve.cpp", *options):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / name
            path.parent.mkdir(parents=True)
            path.write_text("Result<int> solve() {\n" + textwrap.indent(body, "    ") + "\n}\n")
            done = subprocess.run([sys.executable, CHECK, *options, folder], capture_output=True, text=True)
            return done.returncode, done.stdout

    def accepts(self, body, name="stages/solve.cpp"):
        code, out = self.run_check(body, name)
        self.assertEqual(code, 0, body + out)

    def refuses(self, body, what, line=2):
        code, out = self.run_check(body)
        self.assertEqual(code, 1, body)
        self.assertEqual(len(out.splitlines()), 1, out)
        self.assertIn(f"stages/solve.cpp:{line}: ", out)
        self.assertIn(what, out)

    def test_the_one_way(self):
        self.accepts("const auto done = f();\nif (!done.ok()) return done.error();\n")
        self.accepts("if (const auto done = f(); !done.ok()) return done.error();\n")
        self.accepts("if (const auto done = f(); !done.ok()) {\n    g();\n    return done.error();\n}\n")

    def test_other_ways_are_refused(self):
        for other in ("done", "std::move(done)", "std::move(done).error()", "Error{done.error()}",
                      "Error{done.error().code, done.error().message}"):
            self.refuses(f"if (const auto done = f(); !done.ok()) return {other};", "is passed on as")
            self.refuses(f"if (const auto done = f(); !done.ok())\n    return {other};", "is passed on as")

    def test_a_changed_error_is_no_other_spelling(self):
        self.accepts('if (!done.ok()) return Error{done.error().code, name + ": " + done.error().message};')
        self.accepts("if (!done.ok() || done->empty()) return done;")

    def test_it_is_asked_for_ok(self):
        for test in ("if (!done) return {};", "if (done) return {};", "const int x = done ? 1 : 2;"):
            self.refuses(f"{test}\nif (!done.ok()) return done.error();", "is tested with `done.ok()`")
        self.refuses("const auto done = solve();\nif (!done) return 0;", "is tested with `done.ok()`", 3)
        self.refuses("if (const auto done = solve()) use(*done);", "is tested with `done.ok()`")
        self.accepts("if (const auto done = found()) use(*done);")
        self.accepts("const auto done = found();\nif (!done) return 0;")
        self.accepts("if (!done->empty()) return {};\nif (!done.ok()) return done.error();")

    def test_what_nobody_looks_at_is_found(self):
        for body in ("if (!done.ok()) return std::nullopt;", "if (!done.ok()) {\n    g();\n}\n",
                     "if (const auto done = f(); done.ok()) use(*done);",
                     "const bool has = done.ok() && done->empty();\nreturn has;"):
            self.refuses(body, "the error of done is not looked at")
        self.refuses("if (!f(x).ok()) return {};", "the error of this call")
        self.refuses("static_cast<void>(f(x));", "thrown away")

    def test_codes_that_end_where_one_is_told_from_them_are_found(self):
        cancelled = "done.error().code == ErrorCode::kCancelled"
        for body in (f"if ({cancelled}) return done.error();\nreturn use(*done);",
                     f"return {cancelled} ? done.error() : Result<void>();",
                     "if (done.error().code != ErrorCode::kDegenerate) return done.error();\nreturn {};",
                     "return is_cancelled(done.error()) ? done.error() : Result<void>();"):
            self.refuses(f"if (!done.ok()) tell(done.error());\n{body}", "of done some codes end here", 3)
            self.accepts(f"if (!done.ok()) tell(done.error());\n// Expected: no model, no answer\n{body}")
        self.accepts(f"if (!done.ok() && {cancelled}) return {{}};\nif (!done.ok()) return done.error();")
        self.accepts(f"if (!done.ok() && {cancelled}) {{\n    g();\n}} else if (!done.ok()) {{\n    return done.error();\n}}")

    def test_another_result_of_the_name_does_not_count(self):
        self.refuses("{\n    const auto done = f();\n    if (done.ok()) use(*done);\n}\n"
                     "const auto done = g();\nreturn done.error();", "the error of done", 4)
        self.refuses("if (!done.ok()) return {};\nif (x) return done.error();", "the error of done")

    def test_what_is_looked_at_or_handed_on_is_not(self):
        for body in ("if (!done.ok()) tell(done.error());", "if (!done.ok()) keep(done);",
                     "if (done.ok()) use(*done);\nreturn done;", "if (done.ok()) {\n    use(*done);\n} else {\n"
                     "    tell(done.error().message);\n}", "if (!done.ok()) told = done.error().message;\n"
                     "if (done.ok()) use(*done);", "if (!status.ok()) return {};", "// if (!done.ok()) return {};"):
            self.accepts(body)

    def test_a_reason_is_beside_the_test_or_above_it(self):
        self.accepts("if (!done.ok()) return {};  // Expected: no pair starts a model")
        self.accepts("// Expected: no pair starts a model,\n// as of two images\nif (!done.ok()) return {};")
        self.accepts("// Expected: the folder is gone\nif (const auto done = f(); done.ok())\n    use(*done);")
        self.refuses("if (!done.ok()) return {};  // Expected: never", "the error of done")
        self.refuses("// Expected: of the other one\nif (!a.ok()) return {};\nif (!done.ok()) return {};",
                     "the error of done", 4)

    def test_reasons_are_listed(self):
        _, out = self.run_check("if (!done.ok()) return {};  // Expected: no pair starts a model", "graph/a.cpp", "--list")
        self.assertIn("graph/a.cpp:2: no pair starts a model\n", out)


if __name__ == "__main__":
    unittest.main()
