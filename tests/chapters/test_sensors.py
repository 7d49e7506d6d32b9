"""The claims of the chapters on sensors, computed a second time, by other means."""

import json
import re
from functools import cache

import numpy as np
import pytest
from places import REPOSITORY
from scipy.spatial.transform import Rotation

import orientation
import orientation_recordings as recordings
from orientation import dcm_from_rotation_vector
from orientation_workbench.recording import examine


@cache
def cells(name):
    return json.loads((REPOSITORY / "chapters" / f"{name}.ipynb").read_text("utf8"))["cells"]


#: The chapter on what was the second half of it.
FILTERS = "orientation-filters"


def output_of(word, name="orientation-from-sensors"):
    """Return code and output of the only cell whose code contains the word."""
    [cell] = [
        cell
        for cell in cells(name)
        if cell["cell_type"] == "code" and re.search(word, "".join(cell["source"]))
    ]
    return "".join(cell["source"]), "".join(
        "".join(output.get("text", "")) for output in cell["outputs"]
    )


def numbers(text):
    return [float(number) for number in re.findall(r"-?\d+\.?\d*", text)]


def neighbours(values):
    return np.array([np.corrcoef(column[1:], column[:-1])[0, 1] for column in values.T])


def test_what_is_called_still_is_white_and_what_is_held_is_called_so():
    """A hand-held second had been called a table, and its motion a bias."""
    x_imu, ngimu = recordings.x_imu(), recordings.ngimu()
    held, still = x_imu.time < 1, (ngimu.time >= 8.9) & (ngimu.time < 9.9)
    assert neighbours(x_imu.angular_velocity[held]).min() > 0.8
    assert np.abs(neighbours(ngimu.angular_velocity[still])).max() < 3 / np.sqrt(still.sum())
    _, text = output_of("def autocorrelation")
    of_held, of_still = re.findall(r"its autocorrelation (.*)", text)
    assert min(numbers(of_held)) > 0.8 and max(map(abs, numbers(of_still))) < 0.3
    words = (
        "".join("".join(cell["source"]) for cell in cells("orientation-from-sensors"))
        + recordings.x_imu.__doc__
    )
    assert "on a table" not in words.replace("lies still on a table", "")


def test_a_low_pass_filter_makes_a_still_instrument_look_held_until_it_is_averaged():
    """Compare with SciPy's filters, of first and of second order, over five seeds."""
    from scipy.signal import butter, lfilter

    share = 1 - np.exp(-2 * np.pi * 42 / 200)
    for b, a in (([share], [1, share - 1]), butter(2, 42, fs=200)):
        for seed in range(5):
            noise = np.random.default_rng(seed).normal(size=(200 * 101, 3))
            seconds = np.split(lfilter(b, a, noise, axis=0)[200:], 100)
            means = [second.reshape(40, 5, 3).mean(axis=1) for second in seconds]
            as_it_is, averaged = (
                np.mean([np.abs(neighbours(part)) > 1.96 / np.sqrt(len(part)) for part in parts])
                for parts in (seconds, means)
            )
            assert as_it_is > 0.9 and averaged < 0.11
    held, still = (numbers(line[20:]) for line in output_of("def low_pass")[1].splitlines()[2:])
    assert held[1] == 100 and held[3] > 50 and still[1] > 90 and still[3] < 8


def test_a_nearly_level_circle_gives_the_vertical_offset_with_a_bias():
    """Errors in variables give the same mean for any number of poses."""
    text = output_of("def offsets_left")[1].splitlines()
    means = {int(numbers(line)[0]): numbers(line)[-1] for line in text[2:6]}
    many = {int(numbers(line)[0]): numbers(line)[1:] for line in text[7:]}
    for tip in (2, 10):
        # The vertical component varies by the level field times the tip, which is uniform.
        signal = 20**2 * np.radians(tip) ** 2 / 3
        share = 0.5**2 / (0.5**2 + signal)
        assert abs(means[tip] / (44 * share) - 1) < 0.15
        assert all(abs(mean / (44 * share) - 1) < 0.1 for mean in many[tip])


def test_a_mean_of_motion_that_is_taken_for_a_bias_costs():
    """Compute each gain over many stretches, with SciPy's rotations."""
    x_imu = recordings.x_imu()
    end = (x_imu.time > 13) & (x_imu.time < 15)
    last = x_imu.specific_force[end].mean(axis=0)

    def left(gain, bias):
        up, ups = x_imu.specific_force[:100].mean(axis=0), []
        turns = (
            Rotation.from_rotvec((x_imu.angular_velocity - bias) / 256).as_matrix().swapaxes(-1, -2)
        )
        for turn, force in zip(turns, x_imu.specific_force, strict=True):
            up = turn @ up
            up = up + gain / 256 * (force - up)
            up = up / np.linalg.norm(up)
            ups.append(up)
        mean = np.array(ups)[end].mean(axis=0)
        return np.degrees(np.arccos(mean @ last / np.linalg.norm(mean) / np.linalg.norm(last)))

    stretches = [
        (start, start + 0.5 * k) for k in (1, 2, 3, 4) for start in np.arange(0, 2.1 - 0.5 * k, 0.5)
    ]
    for line in output_of("nothing subtracted", FILTERS)[1].splitlines()[2:6]:
        gain, nothing, _, low, high, worse, count = numbers(line)
        assert abs(left(gain, 0) - nothing) < 0.06
        removed = [
            left(
                gain,
                x_imu.angular_velocity[(x_imu.time >= start) & (x_imu.time < stop)].mean(axis=0),
            )
            for start, stop in stretches
        ]
        assert abs(min(removed) - low) < 0.06 and abs(max(removed) - high) < 0.06
        assert (
            sum(error > left(gain, 0) for error in removed) == worse >= (8 if gain else 5)
            and count == 10
        )


def test_two_tests_without_the_truth_convict_different_faults_and_neither_acquits():
    """Compare middle and spread over five draws of a hundred flights."""
    rows = {
        line[:28].strip(): numbers(line[28:])
        for line in output_of("def flights", FILTERS)[1].splitlines()[2:]
    }
    nees, nis, by_nis, by_autocorrelation = (
        {name: row[k] for name, row in rows.items()} for k in (0, 3, 4, 5)
    )
    low, high = rows["true noise"][1:3]
    assert low < 6.3 and high > 5.9 and 5.7 < nees["true noise"] < 6.5
    assert by_nis["true noise"] < 9 and by_autocorrelation["true noise"] < 9
    # Variances a quarter of the true ones everywhere, and so squares four times as large.
    assert nees["half, all sensors"] / nees["true noise"] == pytest.approx(4, rel=0.06)
    assert by_nis["half, all sensors"] == 100 and by_autocorrelation["half, all sensors"] < 9
    assert by_nis["half, gyroscope"] < 25 < 50 < by_autocorrelation["half, gyroscope"]
    assert by_autocorrelation["a tenth, gyroscope"] > 90
    assert nees["double, gyroscope"] < 5 and nees["double, directions"] < 5
    assert nis["double, directions"] == pytest.approx(0.5, abs=0.1)


def test_a_reset_keeps_a_filter_honest_and_the_whole_rotation_longest():
    for line in output_of("def after_one_update", FILTERS)[1].splitlines()[1:]:
        degrees, none, _, _, printed, _, _, whole, _, _ = numbers(line)
        assert whole <= printed <= none and (degrees > 3 or none < 3.2)
        assert (none > 6 and whole < 3.4) if degrees == 12 else True


def test_a_gate_keeps_the_heading_past_a_car_in_every_draw():
    rows = {
        line[:23].strip(): np.reshape(numbers(line[23:]), (5, 2))
        for line in output_of(r"def follow\(", FILTERS)[1].splitlines()[1:]
    }
    middle, worst = rows["no gate"].T
    assert middle.min() > 10 and worst.min() > 35
    assert rows["gate 9.2"][:, 1].max() < 8 and rows["gate 9.2"][:, 0].max() < 1.5
    assert rows["no gate, sure of bias"][:, 0].max() < 5
    assert np.abs(rows["no car, no gate"] - rows["no car, gate 9.2"])[:, 0].max() < 0.3
    seconds = numbers(output_of("longest, ended", FILTERS)[1].splitlines()[-1])
    assert 0.5 < seconds[0] < 2 and seconds[1] > 97


def test_no_setting_of_the_filter_on_the_recording_is_said_to_be_right():
    rows = [
        numbers(line)
        for line in output_of("update at every", FILTERS)[1].splitlines()
        if line[:8].strip()[:1] == "0"
    ]
    assert len(rows) == 10
    for k, (_, _, _, differs, claims, force, field, alike_force, alike_field) in enumerate(rows):
        assert differs > 0.5 and claims > 0.5 and not (1.8 < force < 2.2 and 1.8 < field < 2.2)
        assert alike_field > 0.9 and (alike_force > 0.8) == (k < 5)


def walk(seed, car):
    """Return the file of a phone on a table and then on a walk past a car, with everything varied.

    SciPy computes it as the chapter does.
    """
    random, step = np.random.default_rng(seed), 0.01
    time = np.arange(0, 45, step)
    going = np.clip(time - 8, 0, 1)[:, None]
    foot, look, side = random.uniform(0, 2 * np.pi, 3)
    paces = 2 * np.pi * 1.9 * time + foot
    swing = [
        25 * np.sin(paces),
        12 * np.sin(paces / 2),
        20 * np.sin(2 * np.pi * 0.07 * time + look),
    ]
    rates = going * np.radians(np.column_stack(swing))
    pushes = going * np.column_stack(
        [np.sin(paces + 1), 0.7 * np.sin(paces / 2), 2.5 * np.sin(paces)]
    )
    pose = Rotation.random(random_state=seed)
    ground = [pose]
    for turn in Rotation.from_rotvec((rates[1:] + rates[:-1]) / 2 * step):
        ground.append(ground[-1] * turn)
    phone = Rotation.concatenate(ground).inv()
    steel = np.outer(car & (time > 28) & (time < 33), [10 * np.cos(side), 10 * np.sin(side), 0])
    rows = np.column_stack(
        [
            time,
            rates
            + np.radians(random.normal(scale=0.5, size=3))
            + np.radians(random.normal(scale=0.28, size=rates.shape)),
            phone.apply([0, 0, 9.81] + pushes) + random.normal(scale=0.05, size=rates.shape),
            phone.apply([20.0, 0, -44] + steel) + random.normal(scale=0.5, size=rates.shape),
        ]
    )
    lines = (",".join(f"{number:.5f}" for number in row) for row in rows)
    return "\n".join(["t,wx,wy,wz,ax,ay,az,mx,my,mz", *lines])


def test_the_bench_finds_nothing_wrong_with_walks_without_a_car():
    """The bench had once warned about half of such walks."""
    lights = {examine(walk(seed, False), "walk").light("filter") for seed in range(3)}
    assert lights == {"as it should be"}


def named(word, chapter, *names):
    """Return functions and constants that the only cell with the word defines."""
    scope = {"np": np, **vars(orientation)}
    exec(output_of(word, chapter)[0].partition("\n\n\nahead")[0].partition("\n\ng_A")[0], scope)
    return [scope[name] for name in names]


def active(dcm):
    """Return SciPy's rotation for a direction cosine matrix of this book, its transpose."""
    return Rotation.from_matrix(np.transpose(dcm))


def test_swing_and_twist_by_scipy():
    [swing_twist] = named("def swing_twist", "axis-and-angle", "swing_twist")
    e = np.array([2, -1, 2]) / 3
    for turned in Rotation.random(20, rng=3):
        swing, twist = (
            Rotation.from_quat(q, scalar_first=True)
            for q in swing_twist(turned.as_quat(scalar_first=True), e)
        )
        assert np.allclose((swing * twist).as_matrix(), turned.as_matrix())
        assert np.allclose(np.cross(twist.as_rotvec(), e), 0)
        assert abs(swing.as_rotvec() @ e) < 1e-9
        angle = np.arccos(e @ turned.apply(e))
        assert np.isclose(swing.magnitude(), angle)


def test_misorientation_by_scipy():
    [misorientation] = named("def misorientation", "cases-from-practice", "misorientation")
    group = Rotation.create_group("O")
    grains = [
        Rotation.from_euler("ZXZ", angles, degrees=True) for angles in ([20, 30, 40], [150, 50, 10])
    ]
    between = grains[0].inv() * grains[1]  # along the crystals
    smallest = min((between * symmetry).magnitude() for symmetry in group)
    g_A, g_B = (grain.as_matrix().T for grain in grains)
    assert np.allclose(misorientation(g_A[None], g_B[None]), np.degrees(smallest))


def test_an_error_is_carried_through_a_pose_as_by_differences():
    """Compare with the poses themselves: disturb one, carry it through another, and compare."""
    poses, carrying = named("def carrying", "cases-from-practice", "poses", "carrying")
    random = np.random.default_rng(5)
    through, pose = poses(Rotation.random(2, rng=random).as_matrix(), random.normal(size=(2, 3)))
    errors = 1e-6 * np.eye(6)
    disturbed = poses(dcm_from_rotation_vector(errors[:, :3]), errors[:, 3:]) @ pose
    carried = through @ disturbed @ np.linalg.inv(through @ pose)
    turned = orientation.rotation_vector_from_dcm(carried[:, :3, :3])
    by_differences = np.hstack([turned, carried[:, :3, 3]]) / 1e-6
    assert np.allclose(carrying(through), by_differences.T, atol=1e-5)


def test_a_camera_on_a_hand_is_as_wrong_as_its_covariance_says():
    """Compare with the printed seeds and, for the rotation alone, with the formula."""
    for line in output_of("def calibrations", "cases-from-practice")[1].splitlines()[2:]:
        *_, low, high, low_angle, high_angle, low_place, high_place = numbers(line)
        assert 5.4 < low < high < 6.7
        assert 2.6 < low_angle < high_angle < 3.5 and 2.6 < low_place < high_place < 3.6
    poses, carrying = named("def carrying", "cases-from-practice", "poses", "carrying")
    turns = Rotation.random(10, rng=7)
    turned = np.eye(3) - carrying(poses(turns.as_matrix(), np.zeros((10, 3))))[:, :3, :3]
    information = (turned.swapaxes(-1, -2) @ turned / (4 * 0.01**2)).sum(axis=0)
    axes = turns.as_rotvec() / turns.magnitude()[:, None]
    ours = orientation.directions_covariance(axes, 0.01 / np.sin(turns.magnitude() / 2))
    assert np.allclose(np.linalg.inv(information), ours)


@pytest.mark.long
def test_the_printed_seed_of_the_walks_ranks_as_the_chapter_says():
    """Compare seeds 1 to 6: the middle and worst walk without a gate, and the worst with one."""
    from orientation_recordings.walks import STEP, walks
    from tools.gate import chapter

    names, rows = chapter(), []
    for seed in range(1, 7):
        walked, row = walks(100, seed), []
        for gate in (np.inf, 9.21):
            estimate, predictions, _ = names["follow"](walked, gate)
            errors = names["of_the_filter"](walked, estimate, predictions)
            ends = np.sqrt((errors[:, -round(3 / STEP) :] ** 2).mean(axis=1))
            row += [np.median(ends), ends.max()]
        rows.append(row)
    rows = np.array(rows)
    assert (rows.min(axis=0).round() == [15, 56, 1, 3]).all()
    assert (rows.max(axis=0).round() == [22, 82, 1, 6]).all()
    ranks = 1 + (rows > rows[0]).sum(axis=0)
    assert list(ranks[[0, 1, 3]]) == [2, 4, 1]
