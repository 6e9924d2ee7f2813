"""pelorus-solve: answers as published, refusals that name the cause, exit codes of the design."""

import json
import os
import pathlib
import shutil
import subprocess

import pytest

KEYS = ["n", "status", "best", "best_sq", "second", "second_sq", "ratio", "nodes"]
SMALL = "3\n5.45 3.10 2.97\n6.290 5.978 0.544\n5.978 6.292 2.340\n0.544 2.340 6.288\n"
LOWER = "3\n5.45\n3.10\n2.97\n6.290\n5.978 6.292\n0.544 2.340 6.288\n"


@pytest.fixture(scope="module")
def program():
    path = os.environ.get("PELORUS_BIN")
    found = os.path.join(path, "pelorus-solve") if path else shutil.which("pelorus-solve")
    if not found or not os.path.exists(found):
        pytest.skip("pelorus-solve is not built")
    return found


def run(program, *args, text=None):
    r = subprocess.run([program, *args], input=text, capture_output=True, text=True, timeout=60)
    return r.returncode, r.stdout, r.stderr


def solved(out):
    return [json.loads(line) for line in out.splitlines()]


@pytest.mark.parametrize("text", [SMALL, LOWER, "# a comment\n" + SMALL.replace("\n", "  # so\n\n")])
def test_full_and_lower_triangle_and_comments(program, text):
    code, out, err = run(program, "--json", "-", text=text)
    assert code == 0 and err == ""
    (answer,) = solved(out)
    assert list(answer) == KEYS
    assert answer["n"] == 3 and answer["status"] == "optimal"
    assert answer["best"] == [5, 3, 4] and answer["second"] == [6, 4, 4]
    assert answer["best_sq"] == pytest.approx(0.218331095, abs=1e-8)
    assert answer["second_sq"] == pytest.approx(0.307272576, abs=1e-8)
    assert answer["ratio"] == pytest.approx(answer["second_sq"] / answer["best_sq"], rel=1e-8)


def test_several_problems_and_a_bad_one_among_them(program):
    indefinite = "2\n0.1 0.2\n1 2\n2 1\n"
    too_large = "60\n" + "0.5\n" * 60 + "\n".join(" ".join("1" if i == j else "0" for j in range(60)) for i in range(60)) + "\n"
    code, out, err = run(program, "--json", "-", text=SMALL + indefinite + LOWER + too_large + SMALL)
    answers = solved(out)
    assert [a["status"] for a in answers] == ["optimal", "rejected", "optimal", "rejected", "optimal"]
    assert answers[1] == dict(n=2, status="rejected", best=[], best_sq=None, second=[], second_sq=None, ratio=None, nodes=0)
    assert code == 4
    assert "not positive definite" in err and "60" in err


@pytest.mark.parametrize("text,cause", [
    ("2\n0.1 x\n1\n0 1\n", "not a number"),
    ("2\n0.1 nan\n1\n0 1\n", "not finite"),
    ("2\n0.1 0.2\n1\n", "ends after 1 of 2 rows"),
    ("2\n0.1\n", "ends after 1 of 2 float"),
    ("2\n0.1 0.2\n1 0\n0.5 1\n", "not symmetric"),
    ("2\n0.1 0.2\n1 0\n0\n", "wants 2 numbers"),
    ("2\n0.1 0.2\n0 0\n0 0\n", "not positive definite"),
    ("0\n", "n = 0"),
])
def test_refusals_name_their_cause(program, text, cause):
    code, out, err = run(program, "--json", "-", text=text)
    assert code == 4
    assert solved(out)[0]["status"] == "rejected"
    assert cause in err and err.count("\n") == 1


def test_a_spent_budget_is_a_missed_limit(program):
    code, out, _ = run(program, "--json", "--nodes", "3", "-", text=SMALL)
    (answer,) = solved(out)
    assert code == 1
    assert answer["status"] == "budget" and answer["nodes"] == 3
    assert answer["second"] == [] and answer["second_sq"] is None and answer["ratio"] is None


def test_text_shows_what_json_says(program):
    code, out, _ = run(program, "--best", "3", "-", text=SMALL)
    assert code == 0
    assert "optimal" in out and "ratio 1.407370" in out
    assert "best" in out and "5 3 4" in out and "second" in out and "6 4 4" in out and "third" in out


def test_wrong_usage_is_one_clear_line(program):
    for args, says in ((["--jsom", "-"], "did you mean '--json'"), (["--nodes", "0", "-"], "whole number from 1"), ([], "FILE is missing"),
                       (["a", "b"], "one argument too many")):
        code, out, err = run(program, *args)
        assert code == 2 and out == "" and err.count("\n") == 1 and says in err


def test_unreadable_input(program, tmp_path):
    assert run(program, str(tmp_path / "no"))[0] == 3
    assert run(program, "-", text="# nothing\n")[0] == 3


def test_help_and_version(program):
    code, out, _ = run(program, "--help")
    assert code == 0 and "--nodes" in out and "usage: pelorus-solve" in out
    assert run(program, "--version")[1].startswith("pelorus-solve ")


def reference_files():
    data = os.environ.get("PELORUS_DATA") or str(pathlib.Path(__file__).resolve().parents[2].parent / "shared" / "data")
    return sorted(pathlib.Path(data, "lambda-reference").glob("*.txt"))


def published(path):
    """The two candidates with their squared norms, as the file states them."""
    lines = [line for line in path.read_text().splitlines()]
    out = []
    for i, line in enumerate(lines):
        if line.startswith("# ILS candidate"):
            out.append((float(lines[i + 1]), [int(x) for x in lines[i + 2].split()]))
    return out


def test_reference_problems(program):
    files = reference_files()
    if not files:
        assert os.environ.get("PELORUS_REQUIRE_DATA") != "1", "lambda-reference is absent"
        pytest.skip("lambda-reference is absent (PELORUS_DATA)")
    for path in files:
        code, out, err = run(program, "--json", str(path))
        assert code == 0 and err == "", path.name
        (answer,) = solved(out)
        (sq1, z1), (sq2, z2) = published(path)
        assert (answer["best"], answer["second"]) == (z1, z2), path.name
        assert answer["best_sq"] == pytest.approx(sq1, rel=1e-8) and answer["second_sq"] == pytest.approx(sq2, rel=1e-8)
    together = "\n".join(p.read_text() for p in files)
    code, out, _ = run(program, "--json", "-", text=together)
    assert code == 0 and len(solved(out)) == len(files)
