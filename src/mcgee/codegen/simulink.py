"""Simulink: functions for the MATLAB Function block, and S-functions in C.

Simulink itself is not needed to try them: Octave runs the functions, and the S-functions are
compiled against a stand-in for its header and called the way its engine calls them.
"""

from __future__ import annotations

import re
from importlib.resources import files as resources

from mcgee.codegen import c, matlab
from mcgee.codegen.common import Files, comment, filled, header, readme, vectors
from mcgee.codegen.language import Command, Language, Tool
from mcgee.codegen.unit import Function, Unit


def files(unit: Unit) -> Files:
    name = unit.name
    blocks = {f"{c.symbol(unit, f)}_block.m": block(unit, f) for f in unit.functions}
    s_functions = {f"{s_function(unit, f)}.c": source(unit, f) for f in unit.functions}
    return {
        **matlab.functions(unit),
        **blocks,
        **s_functions,
        f"{name}.h": c.header_file(unit),
        f"{name}.c": c.source(unit),
        f"{name}_mex.m": mex(unit),
        f"{name}_selftest.m": matlab.selftest(unit),
        "README.md": _readme(unit),
        **vectors(unit),
    }


def s_function(unit: Unit, f: Function) -> str:
    return f"{c.symbol(unit, f)}_sfun"


def block(unit: Unit, f: Function) -> str:
    """What a MATLAB Function block holds."""
    ports = ", ".join(a.name for a in f.state)
    results = ", ".join(a.name for a in f.outputs)
    given = [a.name for a in f.state] + ([f"{unit.name}_params()"] if f.takes_parameters else [])
    sizes = "".join(f"assert(numel({a.name}) == {a.size});\n" for a in f.state)
    name = c.symbol(unit, f)
    return (
        f"function [{results}] = {name}_block({ports})\n"
        f"%{name.upper()}_BLOCK  The text of a MATLAB Function block.\n"
        f"%#codegen\n{sizes}[{results}] = {name}({', '.join(given)});\nend\n"
    )


def mex(unit: Unit) -> str:
    calls = "".join(f"mex('{s_function(unit, f)}.c', '{unit.name}.c');\n" for f in unit.functions)
    title = f"{unit.name.upper()}_MEX"
    return (
        f"function {unit.name}_mex()\n%{title}  Compiles the S-functions.\n"
        "folder = cd(fileparts(mfilename('fullpath')));\nback = onCleanup(@() cd(folder));\n"
        f"{calls}end\n"
    )


def _readme(unit: Unit) -> str:
    f = unit.functions[0]
    ports = ", ".join(f"{a.name} ({a.size})" for a in f.state)
    dialog = ""
    if unit.parameters:
        order = ", ".join(p.identifier for p in unit.parameters)
        dialog = (
            f" Its parameter is the vector [{order}], tunable: in a model, "
            f"`struct2array({unit.name}_params())`."
        )
    return readme(
        unit,
        "Simulink",
        "Files that end in `_block.m` are texts of MATLAB Function blocks, which call the other "
        "functions on the path; files that end in `_sfun.c` are S-functions.",
        f"MATLAB Function block: put the folder on the path and paste a `_block.m`. S-function: "
        f"run `{unit.name}_mex`, add an S-Function block and name `{s_function(unit, f)}`.{dialog} "
        f"Ports, in order: {ports}; results follow as outputs, matrices as matrices; sample time "
        f"is inherited and inputs feed through. To simulate, wire qddot of `forward_dynamics` to "
        f"an Integrator for qdot, that to one for q, and both back.",
        f'octave-cli --eval "exit({unit.name}_selftest)"',
    )


# -- the S-function -------------------------------------------------------------------------------


def source(unit: Unit, f: Function) -> str:
    count = len(unit.parameters) if f.takes_parameters else 0
    checked = r"\1" if count else ""
    return comment(header(unit), "/*", " * ", " */") + filled(
        re.sub("CHECK>\n(.*?)<CHECK\n", checked, _S_FUNCTION, flags=re.DOTALL),
        SFUNCTION=s_function(unit, f),
        ROBOT=unit.name,
        DIALOG=str(int(count > 0)),
        COUNT=str(count),
        OUTPORTS=_output_ports(f),
        INPORTS=_input_ports(f),
        INPUTS=str(len(f.state)),
        OUTPUTS=str(len(f.outputs)),
        COMPUTE=_compute(unit, f),
    )


def _input_ports(f: Function) -> str:
    text = ""
    for k, a in enumerate(f.state):
        text += f"    ssSetInputPortWidth(S, {k}, {a.size});\n"
        text += f"    ssSetInputPortRequiredContiguous(S, {k}, 1);\n"
        text += f"    ssSetInputPortDirectFeedThrough(S, {k}, 1);\n"
    return text


def _output_ports(f: Function) -> str:
    text = ""
    for k, a in enumerate(f.outputs):
        if len(a.shape) == 2:
            text += f"    ssSetOutputPortMatrixDimensions(S, {k}, {a.shape[0]}, {a.shape[1]});\n"
        else:
            text += f"    ssSetOutputPortWidth(S, {k}, {a.size});\n"
    return text


def _compute(unit: Unit, f: Function) -> str:
    lines = []
    for k, a in enumerate(f.state):
        lines.append(f"const real_T *{a.name} = ssGetInputPortRealSignal(S, {k});")
    for k, a in enumerate(f.outputs):
        lines.append(f"real_T *{a.name}_port = ssGetOutputPortRealSignal(S, {k});")
    lines += [f"real_T {a.name}[{a.size}];" for a in f.outputs]
    given = [a.name for a in f.state]
    if f.takes_parameters:
        lines.append("const real_T *dialog = mxGetPr(ssGetSFcnParam(S, 0));")
        lines.append(f"{c.params_type(unit)} params;")
        lines += [f"params.{p.identifier} = dialog[{i}];" for i, p in enumerate(unit.parameters)]
        given.append("&params")
    given += [a.name for a in f.outputs]
    lines.append(f"{c.symbol(unit, f)}({', '.join(given)});")
    for a in f.outputs:
        rows, columns = a.shape if len(a.shape) == 2 else (1, a.size)
        lines.append(f"by_columns({a.name}, {a.name}_port, {rows}, {columns});")
    return "".join(f"    {line}\n" for line in lines)


_S_FUNCTION = """
#define S_FUNCTION_NAME SFUNCTION
#define S_FUNCTION_LEVEL 2

#include "simstruc.h"

#include "ROBOT.h"

/* Simulink's matrices lie column by column. */
static void by_columns(const real_T *from, real_T *to, int rows, int columns)
{
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            to[j*rows + i] = from[i*columns + j];
        }
    }
}

CHECK>
#define MDL_CHECK_PARAMETERS
static void mdlCheckParameters(SimStruct *S)
{
    const mxArray *given = ssGetSFcnParam(S, 0);
    if (!mxIsDouble(given) || mxIsComplex(given) || mxGetNumberOfElements(given) != COUNT) {
        ssSetErrorStatus(S, "SFUNCTION takes a real vector of COUNT parameters.");
    }
}

<CHECK
static void mdlInitializeSizes(SimStruct *S)
{
    ssSetNumSFcnParams(S, DIALOG);
    if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) {
        return; /* Simulink says so */
    }
CHECK>
    mdlCheckParameters(S);
    if (ssGetErrorStatus(S)) {
        return;
    }
<CHECK
    ssSetNumContStates(S, 0);
    ssSetNumDiscStates(S, 0);
    if (!ssSetNumInputPorts(S, INPUTS)) {
        return;
    }
INPORTS    if (!ssSetNumOutputPorts(S, OUTPUTS)) {
        return;
    }
OUTPORTS    ssSetNumSampleTimes(S, 1);
    ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);
}

static void mdlInitializeSampleTimes(SimStruct *S)
{
    ssSetSampleTime(S, 0, INHERITED_SAMPLE_TIME);
    ssSetOffsetTime(S, 0, 0.0);
}

static void mdlOutputs(SimStruct *S, int_T tid)
{
    (void)tid;
COMPUTE}

static void mdlTerminate(SimStruct *S)
{
    (void)S;
}

#ifdef MATLAB_MEX_FILE
#include "simulink.c"
#else
#include "cg_sfun.h"
#endif
"""


# -- trying them ----------------------------------------------------------------------------------


def _build(unit: Unit, tools: list[str]) -> list[Command]:
    stand_in = str(resources("mcgee.codegen") / "texts" / "simulink")
    flags = [*c.WARNINGS, "-DMATLAB_MEX_FILE", "-I", stand_in, "-I", "."]
    return [
        [
            *(tools[1], *flags, f'-DS_FUNCTION_FILE="{s_function(unit, f)}.c"'),
            *(f'-DVECTORS="{f.name}"', f"{stand_in}/drive.c", f"{unit.name}.c"),
            *("-o", s_function(unit, f), "-lm"),
        ]
        for f in unit.functions
    ]


def _run(unit: Unit, tools: list[str]) -> list[Command]:
    drives = [[f"./{s_function(unit, f)}"] for f in unit.functions]
    return [*matlab.MATLAB.run(unit, tools), *drives]


SIMULINK = Language(
    "simulink",
    "Simulink",
    files,
    tools=(matlab.OCTAVE, Tool(("gcc", "clang", "cc"), get="apt install gcc")),
    build=_build,
    run=_run,
)
