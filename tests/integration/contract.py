"""api/openapi.yaml as something that replies can be checked against."""
import copy
import json
import re

import jsonschema
import yaml

from drupe import ROOT

API = ROOT / "api"
METHODS = ("get", "put", "post", "delete", "patch", "head")
SERVICE_OF_PORT = {"8081": "capture", "8082": "reconstruction", "8083": "analysis"}

# router.Add("GET", "/reports/{id:rec}.csv", ...) or a local add(...), wherever a line is broken.
REGISTRATION = re.compile(r'\b[Aa]dd\(\s*"(GET|PUT|POST|DELETE|PATCH)",\s*"(/[^"]*)"')
SOURCES_OF_SERVICE = {"capture": "services/capture", "reconstruction": "services/reconstruction",
                      "analysis": "services/defect_analysis"}
SOURCES_OF_ALL = ("shared/http", "shared/service")


def as_template(pattern):
    """A route's pattern as OpenAPI writes it: "/reports/{id:rec}" -> "/reports/{id}"."""
    return re.sub(r"\{(\w+):\w+\}", r"{\1}", pattern)


def registered_routes():
    """{(service, method, path template)} of every route that the sources register."""
    def in_folder(folder):
        for path in sorted((ROOT / folder).rglob("*.cpp")):
            if not path.name.endswith("_test.cpp"):
                for method, pattern in REGISTRATION.findall(path.read_text()):
                    yield method.lower(), as_template(pattern)

    common = [route for folder in SOURCES_OF_ALL for route in in_folder(folder)]
    return {(service, method, path) for service, folder in SOURCES_OF_SERVICE.items()
            for method, path in [*in_folder(folder), *common]}


def plain_schema(schema):
    """An OpenAPI 3.0 schema as JSON Schema: `nullable` becomes the type null."""
    if isinstance(schema, list):
        return [plain_schema(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: plain_schema(value) for key, value in schema.items() if key != "nullable"}
    if schema.get("nullable"):
        plain = {"anyOf": [plain, {"type": "null"}]}
    return plain


class Contract:
    def __init__(self):
        self.text = (API / "openapi.yaml").read_text()
        self.document = yaml.safe_load(self.text)
        self._plain = plain_schema(copy.deepcopy(self.document))
        self._plain.pop("$schema", None)

    def resolve(self, node):
        """Follows a local $ref of a parameter or response."""
        while "$ref" in node:
            target = self.document
            for key in node["$ref"].removeprefix("#/").split("/"):
                target = target[key]
            node = target
        return node

    def operations(self):
        """Yields (services, method, path, operation)."""
        for path, item in self.document["paths"].items():
            servers = item.get("servers", self.document["servers"])
            services = {SERVICE_OF_PORT[server["url"].rsplit(":", 1)[1]] for server in servers}
            for method in METHODS:
                if method in item:
                    yield services, method, path, item[method]

    def routes(self):
        return {(service, method, path) for services, method, path, _ in self.operations() for service in services}

    def find(self, service, method, actual_path):
        """(path template, operation) that a request belongs to; the most literal template comes first."""
        candidates = [(path, operation) for services, m, path, operation in self.operations()
                      if service in services and m == method.lower()]
        for template, operation in sorted(candidates, key=lambda c: (c[0].count("{"), -len(re.sub(r"\{\w+\}", "", c[0])))):
            pattern = "".join("[^/]+" if part.startswith("{") else re.escape(part)
                              for part in re.split(r"(\{\w+\})", template))
            if re.fullmatch(pattern, actual_path.split("?")[0]):
                return template, operation
        return None

    def problems(self, operation, reply):
        """What in `reply` the contract does not foresee, as text lines."""
        responses = operation["responses"]
        if str(reply.status) not in responses:
            return [f"status {reply.status} is not described: {reply.body[:200]!r}"]
        response = self.resolve(responses[str(reply.status)])
        problems = [f"header {name} is missing" for name in response.get("headers", {}) if name.lower() not in reply.headers]
        content = response.get("content")
        if content is None:
            return problems + ([f"an undescribed body: {reply.body[:200]!r}"] if reply.body else [])
        media_type = reply.headers.get("content-type", "").split(";")[0]
        if media_type not in content:
            return problems + [f"content type {media_type!r} is not described"]
        if media_type == "application/json" and reply.status != 206:  # a part of JSON is not JSON
            problems += self.schema_problems(content[media_type]["schema"], reply.json())
        return problems

    def schema_problems(self, schema, value):
        # Local references start at the document, the others at api/.
        resolver = jsonschema.RefResolver(base_uri=API.as_uri() + "/openapi.yaml", referrer=self._plain,
                                          handlers={"file": lambda uri: json.loads((API / uri.rsplit("/api/", 1)[1]).read_text())})
        validator = jsonschema.Draft202012Validator(plain_schema(schema), resolver=resolver)
        return [f"{'/'.join(map(str, error.absolute_path))}: {error.message[:300]}" for error in validator.iter_errors(value)]
