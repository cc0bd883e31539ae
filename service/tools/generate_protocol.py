"""Writes the Python side of proto/fluxfarm/v1/engine.proto into src/fluxfarm/adapters/protocol/.

Generated code must match the protobuf runtime that reads it, so it is made in the environment that runs it and is
never committed. Run with that environment's Python: `python service/tools/generate_protocol.py`.
Does nothing when the output is newer than the .proto file.
"""

import sys
from pathlib import Path

SERVICE = Path(__file__).resolve().parent.parent
PROTO_FOLDER = SERVICE.parent / "proto" / "fluxfarm" / "v1"
OUTPUT = SERVICE / "src" / "fluxfarm" / "adapters" / "protocol"


def main() -> int:
    """Generate the modules; returns protoc's exit status."""
    proto = PROTO_FOLDER / "engine.proto"
    module = OUTPUT / "engine_pb2.py"
    if module.exists() and module.stat().st_mtime > proto.stat().st_mtime:
        return 0
    from grpc_tools import protoc

    OUTPUT.mkdir(parents=True, exist_ok=True)
    (OUTPUT / "__init__.py").write_text('"""Generated from proto/fluxfarm/v1; imported by the codec only."""\n')
    return int(
        protoc.main(["protoc", f"-I{PROTO_FOLDER}", f"--python_out={OUTPUT}", f"--pyi_out={OUTPUT}", str(proto)])
    )


if __name__ == "__main__":
    sys.exit(main())
