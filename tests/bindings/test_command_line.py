"""The command line: what it prints, what it leaves, what it answers to mistakes."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
import webbrowser
from pathlib import Path

import pliant as pl
import pytest
from pliant import cli, selftest


def model() -> pl.Model:
    fall = pl.Model(gravity=(0, 0, -9.81))
    fall.add_point_mass(1.0, at=(0, 0, 0), name="ball")
    return fall


def test_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["demo", "--list"]) == 0
    assert "falling_rope" in capsys.readouterr().out
    assert cli.main(["demo", "falling_rope", "--out", str(tmp_path / "out")]) == 0
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["falling_rope.html", "falling_rope.png"]
    assert cli.main(["demo", "falling_rope", "--test"]) == 0
    assert "FAIL" not in capsys.readouterr().out
    assert cli.main(["demo", "unknown"]) == 2


def test_a_scene_that_fails_its_checks_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    build = pl.scenes.falling_rope

    def wrong() -> pl.scenes.Scene:
        scene = build(elements=4, step=1e-2)
        return dataclasses.replace(scene, expected={"hook gap": pl.scenes.Expected(1.0, 0.1, "made up")})

    monkeypatch.setitem(pl.scenes.SCENES, "falling_rope", wrong)
    assert cli.main(["demo", "falling_rope", "--test"]) == 1
    assert "FAIL hook gap" in capsys.readouterr().out


@pytest.mark.slow
def test_every_scene_is_as_expected(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["demo", "--test"]) == 0
    assert "FAIL" not in capsys.readouterr().out


def test_models_run_and_results_are_viewed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: not opened.append(url))  # type: ignore[func-returns-value]
    saved = tmp_path / "model.json"
    model().save(saved)
    assert cli.main(["run", str(saved), "--duration", "0.5", "--step", "0.01"]) == 0
    assert "50 steps to 0.5 s" in capsys.readouterr().out
    result = pl.Result.load(tmp_path / "model.h5")
    assert len(result.time) == 51
    assert cli.main(["view", str(tmp_path / "model.h5"), "--no-open", "--color", "speed"]) == 0
    assert not opened
    assert "speed" in (tmp_path / "model.html").read_text()
    assert cli.main(["view", str(tmp_path / "model.h5"), "--output", str(tmp_path / "page.html")]) == 0
    assert opened == [(tmp_path / "page.html").as_uri()]


def test_scripts_run_as_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "script.py"
    (tmp_path / "neighbour.py").write_text("WORD = 'beside'")
    script.write_text("import sys, neighbour\nprint(__name__, sys.argv[1:], neighbour.WORD)")
    before = list(sys.argv), list(sys.path)
    assert cli.main(["run", str(script), "--fast", "3"]) == 0
    assert capsys.readouterr().out == "__main__ ['--fast', '3'] beside\n"
    assert (list(sys.argv), list(sys.path)) == before
    script.write_text("import pliant\npliant.Circle(radius=-1.0)")
    assert cli.main(["run", str(script)]) == 1
    assert "radius" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["run", "nothing.json"], 2, "no such file"),
        (["run", "notes.txt"], 2, "script"),
        (["run", "model.json"], 2, "--duration"),
        (["run", "model.json", "--duration", "-1"], 1, "duration"),
        (["run", "model.json", "--duration", "1", "--output", "nowhere/run.h5"], 1, "nowhere"),
        (["run", "script.py", "--step", "1"], 2, "--step"),
        (["run", "broken.json", "--duration", "1"], 1, "broken.json"),
        (["view", "nothing.h5"], 1, "no such file"),
        (["view", "notes.txt"], 1, "not a pliant result"),
    ],
)
def test_mistakes_are_answered(
    words: list[str],
    code: int,
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    model().save("model.json")
    for name in ("notes.txt", "script.py", "broken.json"):
        Path(name).write_text("")
    assert cli.main(words) == code
    assert said in capsys.readouterr().err


def test_unknown_words_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for words in ([], ["dance"], ["info", "--more"], ["run", "model.json", "--fast"]):
        with pytest.raises(SystemExit) as caught:
            cli.main(words)
        assert caught.value.code == 2
        assert "usage: pliant" in capsys.readouterr().err


def test_info_tells_versions_processor_and_threads() -> None:
    run = subprocess.run([sys.executable, "-m", "pliant", "info"], check=True, capture_output=True, text=True)
    for word in (f"pliant {pl.__version__}", "numpy", "processor", "threads"):
        assert word in run.stdout


def test_the_selftest_passes_and_can_fail(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert cli.main(["selftest"]) == 0
    said = capsys.readouterr().out
    assert "FAIL" not in said
    assert said.count("ok  ") == 10
    wrong = selftest.Check("sum", 2.0, 3.0, 0.5, "arithmetic")
    monkeypatch.setattr(selftest, "CHECKS", (lambda: iter([wrong]),))
    assert cli.main(["selftest"]) == 1
    assert "FAIL sum" in capsys.readouterr().out
