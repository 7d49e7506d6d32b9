// node compile.mjs <pyodide.mjs> <compile_wheels.py> <folder>
// Run the Python program in Pyodide, with the folder mounted as /wheels: the byte code must come from the same version
// of Python that will load it.
import { readFileSync } from "node:fs";
import { dirname } from "node:path";
import { pathToFileURL } from "node:url";

const [pyodide, program, folder] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(pyodide));
// By default, Pyodide finds its folder from the trace of an error, which fails in a folder named "book (2)".
const python = await loadPyodide({ indexURL: dirname(pyodide) });
python.mountNodeFS("/wheels", folder);
python.runPython(readFileSync(program, "utf8"), { filename: program });
