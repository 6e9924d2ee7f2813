"""make campaign with few seeds: sigma within the bounds, errors as large as sigma says, no integer wrong, none late."""

import tomllib

import pytest
from campaign import __main__ as campaign
from campaign import judge, scenario

with campaign.TABLE.open("rb") as f:
    CASES = [c for c in tomllib.load(f)["case"] if c["quick"] > 0]


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c['system']} {c['name']}")
def test_few_seeds(case):
    (_, found), = campaign.campaign([case], "quick", jobs=2)
    print("\n" + judge.words(case, found))
    assert judge.complaints(case, found, quick=True) == []


def test_a_figure_beyond_its_bound_is_told():
    case = CASES[0]
    three = lambda x: {"rms": [x, x, x], "sigma": [x, x, x], "nees": 3.0}
    good = {"seeds": 30, "wrong": 0, "first_fix_s": 0.0, "attitude": three(5.0), "velocity": three(0.001), "position": three(0.01)}
    assert judge.complaints(case, good) == []
    assert "velocity east" in judge.complaints(case, good | {"velocity": three(0.004)})[0]
    assert "NEES of attitude" in judge.complaints(case, good | {"attitude": three(5.0) | {"nees": 6.0}})[0]
    assert "1.30 of its sigma" in judge.complaints(case, good | {"position": {"rms": [0.013] * 3, "sigma": [0.01] * 3, "nees": 3.0}})[0]
    assert judge.complaints(case, good | {"wrong": 2}) == ["2 wrong fixes"]


def test_a_scenario_is_changed_where_it_is_told_and_nowhere_else():
    text = "a = 1\n[x]\na = 2 # why\nb = 3\n"
    assert scenario.edited(text, {"x.a": "true"}) == "a = 1\n[x]\na = true\nb = 3\n"
    assert scenario.edited(text, {"a": "7"}).startswith("a = 7\n[x]\na = 2")
    with pytest.raises(KeyError, match="x.c"):
        scenario.edited(text, {"x.c": "1"})


def test_new_tables_of_a_page_take_the_place_of_those_of_their_cases():
    a, b = CASES[:2]
    old = "\n".join(f"\n{judge.title(c)} (`x`)\n\n| {n} |\n\nInnovations: {n}.\n" for c, n in ((a, 1), (b, 2)))
    page = campaign.merged(old, [a, b], {judge.title(b): f"{judge.title(b)} (`x`)\n\n| 3 |\n"})
    assert page.count("**") == 4 and page.index(judge.title(a)) < page.index(judge.title(b))
    assert "| 1 |" in page and "| 2 |" not in page and "| 3 |" in page
