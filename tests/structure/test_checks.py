"""The checks find what they are for: each is given a small tree with one fault."""

import pathlib
import tempfile
import unittest

import check_dashboards
import check_format
import check_goals
import check_headers
import check_includes
import check_invariants
import check_names
import check_quiet
import check_readmes
import check_sizes
import check_symbols
import check_words

STATES = '''#define RUN_STATE_LIST(X) \\
    X(RUN_QUEUED, "queued", RUN_TO(RUN_RUNNING)) \\
    X(RUN_RUNNING, "running", 0)

'''
README = "# A tree\n`api/`, `core/` and `server/`\n"
DIAGRAM = "```mermaid\nstateDiagram-v2\n    queued --> running\n```\n"


class Checks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def put(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def test_an_arrow_that_turns_round_is_found(self):
        self.put("api/scenario/scenario.h", "#pragma once\n")
        self.put("core/base/grid.c", '#include "api/scenario/scenario.h"\n')
        self.assertIn("core/base must not know api", check_includes.check(self.root)[0])

    def test_json_does_not_know_the_scenario(self):
        self.put("api/scenario/scenario.h", "#pragma once\n")
        self.put("api/json/members.c", '#include "api/scenario/scenario.h"\n')
        self.assertIn("api/json must not know api/scenario", check_includes.check(self.root)[0])

    def test_the_solvers_do_not_know_each_other(self):
        self.put("core/micro/micro.h", "#pragma once\n")
        self.put("core/macro/step.c", '#include "core/micro/micro.h"\n')
        self.assertEqual(len(check_includes.check(self.root)), 1)

    def test_an_outside_header_in_the_wrong_file_is_found(self):
        self.put("server/http/http.c", "#include <microhttpd.h>\n#include <unistd.h>\n")
        self.assertEqual(check_includes.check(self.root), [])
        self.put("server/store/store.c", "#include <microhttpd.h>\n")
        self.put("api/text.c", "#include <time.h>\n")
        self.put("api/text.h", "#include <jansson.h>\n#pragma once\n")
        self.assertEqual(len(check_includes.check(self.root)), 4)

    def test_the_own_header_comes_first(self):
        self.put("core/base/grid.h", "#pragma once\n")
        self.put("core/base/grid.c", '#include <math.h>\n#include "core/base/grid.h"\n')
        self.assertEqual(len(check_includes.check(self.root)), 1)

    def test_a_prototype_or_a_member_without_a_comment_is_found(self):
        self.put("core/base/a.h", "/// A.\n\n/// Good.\nint a(void);\nint b(void);\n\nint c(void);\n")
        self.put("core/base/b.h", "/// B.\n\n/// Good.\ntypedef struct b {\n    int x; ///< good\n"
                 "    int y;\n    /// Good.\n    int (*f)(int a,\n             int b);\n} b;\n")
        self.assertEqual([fault.split(" ")[0] for fault in check_headers.check(self.root)],
                         ["core/base/a.h:7:", "core/base/b.h:6:"])

    def test_a_header_says_its_purpose(self):
        self.put("core/base/a.h", "#pragma once\n")
        self.assertEqual(len(check_headers.check(self.root)), 1)

    def test_what_is_too_long_is_found(self):
        self.put("core/base/a.h", "//\n" * 251)
        self.put("core/base/a.c", "int a(void)\n{\n" + "    ;\n" * 78 + "}\n")
        self.put("core/base/b.c", "int a(void)\n{\n" + "    ;\n" * 77 + "}\n" + "//\n" * 800)
        found = check_sizes.check(self.root)
        self.assertEqual(len(found), 3)
        self.assertIn("a() has 81 lines", found[0])

    def test_printing_and_clocks_are_found_but_not_in_comments(self):
        self.put("core/base/a.c", '// printf("")\nconst char *a = "exit(1)";\nsnprintf(b, 1, "");\n')
        self.assertEqual(check_quiet.check(self.root), [])
        self.put("core/base/a.c", "printf(b);\nint t = time(NULL);\n")
        self.assertEqual(len(check_quiet.check(self.root)), 2)

    def test_symbols_start_with_their_files_prefix(self):
        self.assertTrue(check_symbols.is_named_well("store_open", "server/store/write.c"))
        self.assertTrue(check_symbols.is_named_well("cmd_check_run", "server/cli/cmd_check.c"))
        self.assertTrue(check_symbols.is_named_well("bf_fail", "core/base/status.c"))
        self.assertFalse(check_symbols.is_named_well("storeroom", "server/store/store.c"))
        self.assertFalse(check_symbols.is_named_well("core_helper", "core/base/grid.c"))
        self.assertEqual(check_symbols.source_of("b/core/CMakeFiles/beltflow_core.dir/base/grid.c.o"),
                         "core/base/grid.c")

    def test_an_invariant_without_a_test_is_found(self):
        self.put("server/store/store.h", "///   I1  One.\n///   I2  Two.\n")
        self.put("tests/unit/server/store/test_store.c", "// I1\n")
        self.assertEqual(check_invariants.check(self.root), ["server/store/store.h: no test cites I2"])

    def put_readmes(self, **others):
        files = {"README.md": README, "api/README.md": "", "core/README.md": "", "server/README.md": DIAGRAM,
                 "api/run_state.h": STATES, "api/docs/limits.md": "", "api/docs/guarantees.md": ""}
        for name, text in (files | others).items():
            self.put(name, text)

    def test_a_path_that_is_not_there_is_found(self):
        self.put_readmes(**{"api/README.md": "`run_state.h`, `api/run_*.h`, `application/json`\n",
                            "core/README.md": "[x](base/grid.h)\n", "api/docs/limits.md": "`core/b.c`\n"})
        self.assertEqual(check_readmes.check(self.root),
                         ["api/docs/limits.md: `core/b.c` does not exist", "core/README.md: `base/grid.h` does not exist"])

    def test_a_diagram_that_differs_from_the_table_is_found(self):
        self.put_readmes(**{"server/README.md": DIAGRAM.replace("queued --> running", "running --> queued")})
        self.assertEqual(len(check_readmes.check(self.root)), 2)

    def test_a_folder_that_the_first_readme_lacks_and_a_long_one_are_found(self):
        self.put_readmes(**{"README.md": README.replace("`core/`", "") + "\n" * 150})
        self.assertEqual(check_readmes.check(self.root), ["README.md: has more than 150 lines",
                                                          "README.md: does not name `core/`"])

    def test_a_limit_without_a_test_is_found(self):
        self.put("tests/README.md", "")
        self.put("tests/unit/test_a.c", "")
        table = "| what | limit | tests |\n|---|---|---|\n| belts | 256 | `tests/unit/test_a.c` |\n| kinds | 32 | %s |\n"
        def faults(tests):
            self.put_readmes(**{"README.md": README + "`tests/`\n", "api/docs/limits.md": table % tests})
            return check_readmes.check(self.root)
        self.assertEqual(faults("`tests/unit/test_a.c`"), [])
        self.assertEqual(faults(""), ["api/docs/limits.md: 'kinds' names no test"])
        self.assertEqual(faults("`tests/unit/test_a.c`, `tests/unit/helper.c`"),
                         ["api/docs/limits.md: `tests/unit/helper.c` does not exist",
                          "api/docs/limits.md: 'kinds' names `tests/unit/helper.c`, which is not there"])

    def test_a_goal_at_fault_and_an_old_table_of_goals_are_found(self):
        goal = "{ what = 'time', unit = 's', find = '(?P<figure>.+) s', %s }"
        part = "[[part]]\nname = 'a'\nabout = 'b'\ncommand = 'bench_a'\ngoal = [" + goal + "]\n"
        self.put("tests/bench/bench_a.c", "")
        self.put("tests/bench/goals.toml", part % "at_most = 2")
        self.put("tests/bench/README.md", "| `a` | b | time: ≤ 2 s |\n")
        self.assertEqual(check_goals.check(self.root),
                         ["tests/bench/README.md: its table is not what tests/bench/run --table prints"])
        self.put("tests/bench/README.md", "| part | measures | goals |\n|---|---|---|\n"
                 "| `a` | b | time: ≤ 2 s |\n")
        self.assertEqual(check_goals.check(self.root), [])
        self.put("tests/bench/goals.toml", part.replace("figure>", "value>").replace("bench_a", "bench_b") % "best = 'least'")
        self.assertEqual(len(check_goals.check(self.root)), 3)

    def test_a_name_with_a_word_of_several_meanings_is_found(self):
        self.put("core/base/a.c", "// keep\nint n = floor(x);\nconst char *a = \"keep\";\n")
        self.put("server/http/a.c", "int how = SHUT_RDWR;\n")
        self.assertEqual(check_names.check(self.root), [])
        self.put("core/base/a.c", "int keep_it;\nint SHUT_RDWR;\n")
        self.assertEqual([fault.split(" ")[0] for fault in check_names.check(self.root)],
                         ["core/base/a.c:1:", "core/base/a.c:2:"])

    def test_postponed_work_is_found(self):
        self.put("core/base/a.c", "// TO" "DO: later\n")
        self.assertEqual(len(check_words.check(self.root)), 1)

    def test_what_clang_format_would_change_is_found(self):
        self.put("core/base/a.c", "int a;\n")
        self.put("web/a.css", "a {}\n")
        self.assertEqual(check_format.check(self.root), [])
        self.put("core/base/a.c", "int   a;\n")
        self.put("web/a.css", "a {} \n\tb {}")
        self.assertEqual(len(check_format.check(self.root)), 4)

    def test_a_query_for_a_metric_that_is_not_there_is_found(self):
        self.put("server/base/metrics.h", '#define X "beltflow_runs" "beltflow_wait_seconds"\n')
        self.put("deploy/grafana/a.json",
                 '{"panels": [{"expr": "sum(beltflow_runs) + beltflow_wait_seconds_bucket"}]}')
        self.assertEqual(check_dashboards.check(self.root), [])
        self.put("deploy/grafana/b.json", '{"panels": [{"expr": "rate(beltflow_walks[1m])"}]}')
        self.assertIn("beltflow_walks", check_dashboards.check(self.root)[0])


if __name__ == "__main__":
    unittest.main()
