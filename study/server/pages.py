# SPDX-License-Identifier: MIT
"""Serves the study page, its assets and the clips."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from fastapi import FastAPI, Request, Response
from fastapi.responses import FileResponse, HTMLResponse

from verisim.study.server.api_error import ApiError

DIST = Path(__file__).resolve().parent.parent / "web" / "dist"
ONE_YEAR = "public, max-age=31536000, immutable"
NOT_BUILT = """<!doctype html>
<html lang="en"><meta charset="utf-8"><title>Study page not built</title>
<h1>The study page has not been built yet</h1>
<p>The server runs, but the page that participants see is missing.</p>
<p>In the checkout, run <code>./verisim demo</code>, which builds it, or
<code>npm ci &amp;&amp; npm run build</code> in <code>study/web</code>. Then load this page
again.</p>
</html>
"""


def add_pages(app: FastAPI, clips: Mapping[str, Path], dist: Path = DIST) -> None:
    """Adds the routes. clips: sha256 → file; nothing else of the set's directory can be reached."""

    @app.get("/")
    def index() -> Response:
        page = dist / "index.html"
        headers = {"cache-control": "no-store"}
        if not page.is_file():
            return HTMLResponse(NOT_BUILT, status_code=503, headers=headers)
        return HTMLResponse(page.read_text(encoding="utf-8"), headers=headers)

    @app.get("/app/{name:path}")
    def asset(name: str) -> Response:
        file = find_asset(dist, name)
        return FileResponse(file, headers={"cache-control": "no-cache"})

    @app.api_route("/media/{name}", methods=["GET", "HEAD"])
    def clip(name: str, request: Request) -> Response:
        sha256 = name.removesuffix(".mp4")
        if name == sha256 or sha256 not in clips:
            raise ApiError(404, "no_such_clip", "no clip of this study", "ask GET /api/next")
        # The name is the content's hash, so a copy that the browser holds is right for ever.
        etag = f'"{sha256}"'
        headers = {"cache-control": ONE_YEAR, "etag": etag}
        if etag in request.headers.get("if-none-match", ""):
            return Response(status_code=304, headers=headers)
        path = clips[sha256]
        return FileResponse(path, media_type="video/mp4", headers=headers, stat_result=path.stat())


def find_asset(dist: Path, name: str) -> Path:
    """Returns a file below `dist`. Raises ApiError 404 for anything else."""
    missing = ApiError(404, "no_such_file", "no such file of the page")
    if "\0" in name:
        raise missing
    file = (dist / name).resolve()
    if not file.is_relative_to(dist.resolve()) or not file.is_file():
        raise missing
    return file
