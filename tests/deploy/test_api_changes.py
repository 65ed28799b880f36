"""The differences of two documents of the API, as deploy/api-changes prints them."""

import copy
import importlib.machinery
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "deploy/api-changes"
loader = importlib.machinery.SourceFileLoader("api_changes", str(TOOL))
api_changes = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(api_changes)


def json_answer(reference):
    return {"description": "It", "content": {"application/json": {"schema": {"$ref": f"#/components/schemas/{reference}"}}}}


DOCUMENT = {
    "paths": {
        "/v1/runs": {"get": {
            "operationId": "listRuns",
            "parameters": [{"name": "limit", "in": "query", "schema": {"type": "integer", "maximum": 100}}],
            "responses": {"200": json_answer("Run"), "404": {"$ref": "#/components/responses/NotFound"}}}},
        "/v1/runs/{id}": {
            "parameters": [{"name": "id", "in": "path", "required": True, "schema": {"type": "string"}}],
            "delete": {"operationId": "deleteRun", "responses": {"204": {"description": "It is gone"}}}}},
    "components": {
        "responses": {"NotFound": json_answer("Problem")},
        "schemas": {
            "Problem": {"type": "object", "properties": {"title": {"type": "string"}}, "required": ["title"]},
            "Run": {"type": "object", "properties": {
                "id": {"type": "string", "description": "Its name"},
                "eta_s": {"type": ["number", "null"]}}, "required": ["id"]}}},
}


class TestApiChanges(unittest.TestCase):
    def differ(self, change):
        new = copy.deepcopy(DOCUMENT)
        change(new)
        return api_changes.differences(DOCUMENT, new)

    def test_texts_are_no_difference(self):
        found = self.differ(lambda d: d["components"]["schemas"]["Run"]["properties"]["id"].update(description="Else"))
        self.assertEqual(found, {"Removed": [], "Changed": [], "Added": []})

    def test_what_is_removed_or_added_as_a_whole_is_one_line(self):
        found = self.differ(lambda d: d["paths"].pop("/v1/runs/{id}"))
        self.assertEqual(found["Removed"], ["- `DELETE /v1/runs/{id}`: deleteRun"])
        found = self.differ(lambda d: d["components"]["schemas"].update(
            Part={"type": "object", "properties": {"x_m": {"type": "number"}}}))
        self.assertEqual(found, {"Removed": [], "Changed": [], "Added": ["- schema `Part`: object"]})

    def test_a_member_is_told_with_its_type_and_whether_it_is_there(self):
        def change(document):
            run = document["components"]["schemas"]["Run"]
            run["properties"]["label"] = {"type": "string", "maxLength": 100}
            run["required"] = ["id", "eta_s"]

        found = self.differ(change)
        self.assertEqual(found["Added"], ["- schema `Run`: member `label`: string, maxLength 100"])
        self.assertEqual(found["Changed"], ["- schema `Run`: member `eta_s`: number or null became number or null, required"])

    def test_parameters_answers_and_media_types_are_compared(self):
        def change(document):
            listed = document["paths"]["/v1/runs"]["get"]
            listed["parameters"][0]["schema"]["maximum"] = 50
            listed["responses"]["200"]["content"] = {"text/csv": {"schema": {"type": "string"}}}
            del listed["responses"]["404"]

        found = self.differ(change)
        self.assertEqual(found["Changed"], [
            "- `GET /v1/runs`: query parameter `limit`: integer, maximum 100 became integer, maximum 50",
            "- `GET /v1/runs`: answer 200: application/json: Run became text/csv: string"])
        self.assertEqual(found["Removed"], ["- `GET /v1/runs`: answer 404: application/json: Problem"])

    def test_a_form_of_a_schema_has_members_of_its_own(self):
        def change(document):
            document["components"]["schemas"]["Run"] = {"oneOf": [
                {"title": "by_id", "type": "object", "properties": {"id": {"type": "string"}}, "required": ["id"]}]}

        self.assertIn("- schema `Run` (by_id): object", self.differ(change)["Added"])

    def test_files_are_read_and_lists_printed(self):
        with tempfile.TemporaryDirectory() as folder:
            new = copy.deepcopy(DOCUMENT)
            new["paths"]["/v1/runs"]["get"]["operationId"] = "listAll"
            paths = [pathlib.Path(folder, name) for name in ("old.json", "new.json")]
            for path, document in zip(paths, (DOCUMENT, new)):
                path.write_text(json.dumps(document), encoding="utf-8")
            done = subprocess.run([sys.executable, TOOL, *paths], capture_output=True, text=True, check=True)
            self.assertEqual(done.stdout, "Changed:\n\n- `GET /v1/runs`: listRuns became listAll\n\n")
            refused = subprocess.run([sys.executable, TOOL, "no-such-commit"], capture_output=True, text=True, check=False)
            self.assertEqual(refused.returncode, 1)
            self.assertIn("no-such-commit is no file", refused.stderr)


if __name__ == "__main__":
    unittest.main()
