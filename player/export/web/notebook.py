"""A clip in a notebook: its page in a frame."""

from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

from gclip import Clip
from player.export.film import Film
from player.export.web.page import write

HEIGHT = 540  # pixels


def iframe(clip: Clip, height: int = HEIGHT) -> str:
    """The page that plays a clip, as the HTML of a frame that needs nothing from outside.

    Parameters
    ----------
    clip : gclip.Clip
    height : int
        Of the frame, in pixels; it is as wide as the notebook.

    Returns
    -------
    str
    """
    with TemporaryDirectory() as folder:
        page = Path(folder, "clip.html")
        write(clip, Film(name="plant"), page, lambda done, total: None)
        document = escape(page.read_text("utf-8"))
    return f'<iframe srcdoc="{document}" width="100%" height="{height}" style="border: 0"></iframe>'
