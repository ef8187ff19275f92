"""Requests to `restitution app`, without a browser."""

import http.client
import json
import re

from app_process import App

CASE = """
total_error = false
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
density = "7850 kg/m^3"
[interface]
yield_pressure = "1 GPa"
[grid]
nodes = 64
spacing = "1 um"
[indentation]
values = ["100 nm", "200 nm"]
"""


class Client(App):
    """`restitution app`, and requests to it."""

    def __init__(self, folder):
        super().__init__(folder, CASE)
        self.port, self.token = re.fullmatch(
            r"http://127.0.0.1:(\d+)/#(\S+)", self.address
        ).groups()

    def ask(self, method, path, body=None, **headers):
        """The status, headers and text of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", int(self.port), timeout=60)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        given = {"Content-Type": "application/json", "X-Token": self.token, **named}
        sent = {name: value for name, value in given.items() if value is not None}
        text = json.dumps(body) if isinstance(body, dict) else body
        connection.request(method, path, text, sent)
        answer = connection.getresponse()
        reply = answer.status, answer.headers, answer.read().decode(errors="replace")
        connection.close()
        return reply

    def post(self, name, **values):
        """The lines of a request that is answered."""
        status, _, text = self.ask("POST", f"/api/{name}", values)
        assert status == 200, text
        return [json.loads(line) for line in text.splitlines()]

    def download(self, values):
        """The status and bytes of a file to take away."""
        connection = http.client.HTTPConnection("127.0.0.1", int(self.port), timeout=60)
        headers = {"Content-Type": "application/json", "X-Token": self.token}
        connection.request("POST", "/api/take", json.dumps(values), headers)
        answer = connection.getresponse()
        reply = answer.status, answer.read()
        connection.close()
        return reply

    def upload(self, name, content):
        headers = {"Content_Type": "application/octet-stream", "X_File_Name": name, "X_Tab": "a"}
        return self.ask("POST", "/api/upload", content, **headers)

    def content(self):
        return self.post("start")[0]["content"]

    def scans(self):
        (room,) = self.folder.glob("restitution-app-*")
        return sorted(path.name for path in (room / "scans").iterdir())
