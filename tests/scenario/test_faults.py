"""A part of the fault campaign at each test: every fault and line once, in a phase that turns with the list. All of it: make faults."""

import fault_campaign
import pytest

QUICK = [c for i, c in enumerate(dict.fromkeys((f, line) for f, line, _ in fault_campaign.cells()))
         for c in [(*c, fault_campaign.PHASES[i % 3])]]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("faults")
    return {(c["fault"], c["line"], c["phase"]): c for c in fault_campaign.campaign(QUICK, folder)}


@pytest.mark.parametrize("cell", QUICK, ids=" ".join)
def test_status_recovery_and_bound_are_as_the_table_says(found, cell):
    assert not fault_campaign.complaints(found[cell], fault_campaign.expectations().get(cell))


def test_the_table_has_every_cell_and_no_other():
    assert set(fault_campaign.expectations()) == set(fault_campaign.cells())


@pytest.mark.parametrize("fault", fault_campaign.FAULTS)
def test_a_fault_changes_its_line_and_no_other(tmp_path_factory, fault):
    folder = tmp_path_factory.getbasetemp() / "faults_seen"
    folder.mkdir(exist_ok=True)
    for line in fault_campaign.FAULTS[fault][2]:
        rows, clean, _, _ = fault_campaign.faulty(folder, fault, line, "converged")
        of = lambda r, mine: [x for x in r if (x[1] == fault_campaign.LINES[line]) == mine]
        assert of(rows, True) != of(clean, True) and sorted(of(rows, False)) == sorted(of(clean, False))


def test_the_campaign_can_fail(tmp_path):
    """A gyro stuck for 5 s without a word is beyond its bound unless the table allows it."""
    fault_campaign.prepare(tmp_path)
    cell = fault_campaign.judge((tmp_path, "gyro saturated, silent", "imu", "converged"))
    assert any("bound" in c for c in fault_campaign.complaints(cell, ["fixed", 1]))
    assert any("status" in c for c in fault_campaign.complaints(cell, ["as ever", 1, 9]))
    assert any("recovered" in c for c in fault_campaign.complaints(cell, ["none", 0, 9]))
