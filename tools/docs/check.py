"""Checks finished pages: dead links, parts from other servers, and paths of this machine."""
import glob
import html.parser
import os
import sys
import urllib.parse


class Look(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__(convert_charrefs=True)
        self.anchors, self.links, self.loads = {""}, [], []
        self.feed(open(path, encoding="utf-8").read())

    def handle_starttag(self, tag, attributes):
        a = dict(attributes)
        self.anchors |= {a[key] for key in ("id", "name") if a.get(key)}
        if tag == "a" and a.get("href") is not None:
            self.links.append(a["href"])
        if tag == "link" and a.get("rel") not in ("prev", "next", "search", "index") or a.get("src"):
            self.loads.append(a.get("src") or a.get("href") or "")


def faults(folder):
    pages = {os.path.realpath(p): Look(p) for p in glob.glob(f"{folder}/**/*.html", recursive=True)}
    machine = {os.getcwd(), os.path.expanduser("~") + "/", os.path.realpath(folder)}
    for path, page in pages.items():
        name = os.path.relpath(path, folder)
        for link in page.loads + page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                if link in page.loads and parts.scheme != "data":
                    yield f"{name}: loads {link}"
                continue
            there = os.path.join(os.path.dirname(path), urllib.parse.unquote(parts.path)) if parts.path else path
            there = os.path.realpath(there)
            if not os.path.isfile(there):
                yield f"{name}: a link to {link}, which does not exist"
            elif there in pages and urllib.parse.unquote(parts.fragment) not in pages[there].anchors:
                yield f"{name}: a link to {link}, an anchor that the page does not have"
        text = open(path, encoding="utf-8").read()
        for word in machine:
            if word in text:
                yield f"{name}: names {word}, a path of this machine"


if __name__ == "__main__":
    found = sorted(set(faults(sys.argv[1])))
    print("\n".join(found) or f"{len(glob.glob(sys.argv[1] + '/**/*.html', recursive=True))} pages, no fault")
    sys.exit(bool(found))
