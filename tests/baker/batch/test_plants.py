"""Which plants a user means."""

import os
from pathlib import Path

import pytest

from baker.batch.plants import find_plants
from baker.cli import main
from baker.errors import InputError
from tests.baker.batch.conftest import write_plant


def names(plants: dict[str, Path]) -> list[str]:
    return list(plants)


def test_folders_are_plants_files_and_one_folder_are_not(greenhouse, tmp_path):
    house = greenhouse(["p2", "p10"])
    folders = [house / "p2", house / "p10"]
    assert names(find_plants(folders, f"{tmp_path}/clips/")) == ["p2", "p10"]
    assert find_plants([house / "p2"], "plant.gclip") == {}
    assert find_plants(sorted((house / "p2").iterdir()), "plant.gclip") == {}


def test_a_folder_of_folders_of_scans_is_a_greenhouse(greenhouse, tmp_path):
    house = greenhouse(["p2", "p10"])
    (house / "notes").mkdir()
    (house / "notes" / "readme.txt").write_text("nothing")
    write_plant(house / ".trash", 0)
    assert names(find_plants([house], f"{tmp_path}/clips/")) == ["p2", "p10"]


def test_one_folder_into_a_folder_is_one_plant_of_a_greenhouse(greenhouse, tmp_path):
    house = greenhouse(["p1"])
    assert names(find_plants([house / "p1"], f"{tmp_path}/")) == ["p1"]


def test_the_folder_of_the_clips_is_no_plant(greenhouse):
    house = greenhouse(["p1", "p2"])
    clips = house / "clips"
    clips.mkdir()
    found = find_plants([clips, house / "p1", house / "p2"], str(clips))
    assert names(found) == ["p1", "p2"]


def test_a_plant_has_its_folders_own_name(greenhouse, monkeypatch):
    monkeypatch.chdir(greenhouse(["p1"]) / "p1")
    assert names(find_plants([Path(".")], "../")) == ["p1"]


def test_the_clips_of_many_plants_are_in_a_folder(greenhouse, tmp_path, monkeypatch, capsys):
    house = greenhouse(["p1", "p2"])
    monkeypatch.chdir(tmp_path)
    assert names(find_plants([house], "clips")) == ["p1", "p2"]
    assert main([str(house), "-o", "house.gclip"]) == 2
    assert "house.gclip is a file's name" in capsys.readouterr().err


def test_mixtures_and_namesakes_are_told(greenhouse, tmp_path):
    house = greenhouse(["p1", "p2"])
    scan = house / "p1" / "day00.txt"
    clips = f"{tmp_path}/"
    with pytest.raises(InputError, match=r"day00\.txt' is a file and .*p2"):
        find_plants([scan, house / "p2"], clips)
    other = write_plant(tmp_path / "other" / "p1", 7)
    with pytest.raises(InputError, match=r"house/p1.*other/p1.*p1\.gclip"):
        find_plants([house / "p1", other], clips)
    with pytest.raises(InputError, match="No such file"):
        find_plants([house / "p1", house / "p3"], clips)


def test_a_folder_without_any_scans_is_told(tmp_path):
    (tmp_path / "empty" / "below").mkdir(parents=True)
    with pytest.raises(InputError, match="holds no scans"):
        find_plants([tmp_path / "empty"], f"{tmp_path}/clips{os.sep}")
