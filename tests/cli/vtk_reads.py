"""Checks the files of `hifdm export --vtk`, and the grid in a result.

    vtk_reads.py RESULT FOLDER    VTK (python3-vtk9) reads every file of `hifdm export --vtk` in FOLDER
    vtk_reads.py RESULT           VTK reads the grid in the result itself

Point and cell data must be the numbers of the result file, bit by bit. Without VTK, h5py reads the same files. This
does not prove that VTK can read them."""
import os
import sys

import h5py
import numpy as np

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    vtk = None
    print("no VTK here: the files are read by h5py alone")

CELLS = {(3, 2), (5, 3), (9, 4)}  # lines, triangles, quadrilaterals in VTK's numbers, and their points
FORCES = ["tension_N", "q_N_per_m", "length_m"]
LAWS = ["tension", "length", "force_density", "elastic"]


def by_vtk(path):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetClassName() == "vtkUnstructuredGrid", grid
    cells = []
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        assert (cell.GetCellType(), cell.GetNumberOfPoints()) in CELLS
        cells.append([cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())])

    def arrays(data):
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    return (vtk_to_numpy(grid.GetPoints().GetData()), cells, arrays(grid.GetPointData()),
            arrays(grid.GetCellData()))


def by_h5py(path):
    grid = h5py.File(path, "r")["VTKHDF"]
    assert grid.attrs["Version"].tolist() == [1, 0] and grid.attrs["Type"] == b"UnstructuredGrid"
    points, corners, start = grid["Points"][:], grid["Connectivity"][:], grid["Offsets"][:]
    cells = [corners[a:b].tolist() for a, b in zip(start, start[1:])]
    assert grid["NumberOfPoints"][:].tolist() == [len(points)] and grid["NumberOfCells"][:].tolist() == [len(cells)]
    assert grid["NumberOfConnectivityIds"][:].tolist() == [len(corners)] == [start[-1]] and start[0] == 0
    assert grid["Types"].dtype == np.uint8 and set(zip(grid["Types"][:], map(len, cells))) <= CELLS
    return (points, cells, {n: d[:] for n, d in grid["PointData"].items()},
            {n: d[:] for n, d in grid["CellData"].items()})


def same(name, one, other):
    one, other = np.asarray(one), np.asarray(other)
    assert one.shape == other.shape and one.astype(other.dtype).tobytes() == other.tobytes(), name


def errors(points, cell, kind, f):
    """Returns the errors along the normal at 3 x 3 points of a facet, and their weights, projected area. In a triangle
    the side v = 1 is its third corner. More points change the RMS by 1e-5 of it, because the slope of a deep dish
    changes over a facet."""
    x, w = np.polynomial.legendre.leggauss(3)
    u, v = (g.ravel() for g in np.meshgrid((x + 1) / 2, (x + 1) / 2))
    w = np.outer(w, w).ravel() / 4
    far = [cell[2], cell[2] if len(cell) == 3 else cell[3]]
    cell = [cell[0], cell[1], *far]
    shape = np.array([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    du, dv = np.array([v - 1, 1 - v, v, -v]), np.array([u - 1, -u, u, 1 - u])
    p, a, b = shape.T @ points[cell], du.T @ points[cell], dv.T @ points[cell]
    c = np.array([1, kind == 2, 0]) / (4 * f)  # z = c . (x^2, y^2)
    slope = 2 * c * p
    weight = w * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    assert (weight > 0).all(), "a facet that is not counter-clockwise"
    return (p[:, 2] - (c * p * p).sum(1)) / np.sqrt(1 + (slope**2).sum(1)), weight


def check_facets(result, path, stage, read):
    points, cells, point, cell = read(path)
    same("points", points, (result[stage] if stage else result["scene/node"])["position_m"][:])
    cables = {frozenset(e) for e in result["scene/cable/end"][:].tolist()}
    supports = set(np.flatnonzero(result["scene/node/role"][:] == 0))
    assert all(frozenset((c[k - 1], c[k])) in cables or {c[k - 1], c[k]} <= supports  # at a rim without cables
               for c in cells for k in range(len(c)))
    settings = result["surface"].attrs
    is_flat = not settings["mesh_tension_N_per_m"] > 0
    area = np.zeros(len(cells))
    for i, corners in enumerate(cells):
        e, w = errors(points, corners, settings["kind"], settings["focal_length_m"])
        area[i] = w.sum()
        mean, rms = (e * w).sum() / area[i], np.sqrt((e * e * w).sum() / area[i])
        if stage and not is_flat:
            continue  # tests/verify/mesh_oracle.py
        assert abs(cell["normal_mean_m"][i] - mean) <= 1e-9 * rms and abs(cell["normal_rms_m"][i] - rms) <= 1e-9 * rms
    if not stage:
        return
    said = result["surface"][stage].attrs
    assert said["n_facet"] == len(cells)
    for name in ("normal", "fit_normal"):
        rms = np.sqrt((area * cell[f"{name}_rms_m"] ** 2).sum() / area.sum())
        assert abs(rms - said["facet_" + name + "_rms_m"]) <= 1e-9 * rms, name
        assert (np.abs(cell[f"{name}_mean_m"]) <= cell[f"{name}_rms_m"] * (1 + 1e-12)).all()
    same("role", point["role"], result["scene/node/role"][:])
    same("displacement_m", point["displacement_m"], points - result["scene/node/position_m"][:])


def check(result, path, stage, read):
    points, cells, point, cell = read(path)
    ends = np.array(cells)
    scene, target = result["scene"], result["scene/node/position_m"][:]
    shape = result[stage] if stage else None
    same("points", points, shape["position_m"][:] if stage else target)
    same("ends", ends, scene["cable/end"][:])
    same("role", point["role"], scene["node/role"][:])
    same("group", cell["group"], scene["cable/group"][:])
    same("law", cell["law"], (shape if stage else scene["cable"])["law"][:])
    same("length", cell["length_m"], shape["length_m"][:] if stage else scene["cable/length_m"][:])
    for name, place, where in (("load_N", point, "node"), ("EA_N", cell, "cable")):
        assert (name in place) == (f"{where}/{name}" in scene), name
        if name in place:
            same(name, place[name], scene[f"{where}/{name}"][:])
    assert ("normal_error_m" in point) == ("surface" in result)
    if not stage:
        assert "tension_N" not in cell and "displacement_m" not in point
        return
    for name in ("tension_N", "q_N_per_m"):
        same(name, cell[name], shape[name][:])
    same("length_change_m", cell["length_change_m"], shape["length_m"][:] - scene["cable/length_m"][:])
    same("displacement_m", point["displacement_m"], shape["position_m"][:] - target)
    moved = shape["position_m"][:] - target
    same("deviation_m", point["deviation_m"], np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2 + moved[:, 2] ** 2))
    psi_m = np.sqrt((point["deviation_m"][point["role"] == 1] ** 2).mean())
    said_m = shape.attrs["psi_m"]
    assert abs(psi_m - said_m) <= 1e-12 * psi_m + 1e-15, (psi_m, said_m)  # the order of a sum
    slack = result["form"].attrs["n_slack"] if stage == "form" else 0
    assert cell["slack"].sum() == slack, (cell["slack"].sum(), slack)
    if "surface" in result:
        rms_m = np.sqrt((point["normal_error_m"][point["role"] == 1] ** 2).mean())
        assert abs(rms_m - result["surface"][stage].attrs["normal_rms_m"]) <= 1e-12 * rms_m


def check_truss(result, path, stage, read):
    points, cells, point, cell = read(path)
    ends = np.array(cells)
    node, member = result["truss/node"], result["truss/member"]
    same("points", points, node["position_m"][:])
    same("ends", ends, member["end"][:])
    same("mass_kg", point["mass_kg"], node["mass_kg"][:])
    same("unit", cell["unit"], member["unit"][:])
    same("joint", cell["joint"], member["joint"][:])
    same("fixed", point["fixed"], (node["fixed"][:].astype(int) << np.arange(6)).sum(axis=1))
    same("displacement_m", point["displacement_m"], node["displacement"][:, :3])
    same("rotation_rad", point["rotation_rad"], node["displacement"][:, 3:])
    same("axial_force_N", cell["axial_force_N"], member["end_force"][:, 6])
    along = points[ends[:, 1]] - points[ends[:, 0]]
    length = np.linalg.norm(along, axis=1)
    longer = ((point["displacement_m"][ends[:, 1]] - point["displacement_m"][ends[:, 0]]) * along).sum(axis=1) / length
    tension = member["E_Pa"][:] * member["A_m2"][:] * longer / length
    assert np.allclose(cell["axial_force_N"], tension, rtol=0, atol=1e-6 * np.abs(tension).max())


def by_calculator(path, formula):
    """Returns the points after ParaView's filter Calculator with Coordinate Results."""
    reader, calculator = vtk.vtkHDFReader(), vtk.vtkArrayCalculator()
    reader.SetFileName(path)
    calculator.SetInputConnection(reader.GetOutputPort())
    calculator.CoordinateResultsOn()
    calculator.SetResultArrayType(vtk.VTK_DOUBLE)
    for name in ("coords", *by_vtk(path)[2]):
        if name == "coords":
            calculator.AddCoordinateVectorVariable(name)
        elif name.endswith("position_m"):
            calculator.AddVectorArrayName(name)
    calculator.SetFunction(formula)
    calculator.Update()
    return vtk_to_numpy(calculator.GetOutput().GetPoints().GetData())


def check_result(path):
    """Checks that the grid of a result has all arrays of the other groups and no others, and that the positions of its
    stages and load cases can become the coordinates."""
    result = h5py.File(path, "r")
    assert result.attrs["finished"]
    scene, shapes = result["scene"], {"form": result["form"]}
    if "search/position_m" in result:
        shapes["search"] = result["search"]
    if "refine" in result:
        shapes["refine"] = result["refine"]
    last = shapes["refine" if "refine" in shapes and result["refine"].attrs["is_result"] else
                  "search" if "search" in shapes else "form"]
    if "load_cases" in result:
        shapes.update({f"load_case_{n}": g for n, g in result["load_cases"].items()
                       if n != "name" and "position_m" in g})
    point = {f"{name}_position_m": shape["position_m"] for name, shape in shapes.items()}
    cell = {f"{name}_{of}": shape[of] for name, shape in shapes.items() for of in FORCES}
    cell.update({of: last[of] for of in FORCES}, group=scene["cable/group"])
    cell["length_at_target_m"] = scene["cable/length_m"]
    point.update(role=scene["node/role"], target_position_m=scene["node/position_m"])
    point.update({"load_N": scene["node/load_N"]} if "load_N" in scene["node"] else {})
    cell.update({"EA_N": scene["cable/EA_N"]} if "EA_N" in scene["cable"] else {})
    if "tolerance" in result:
        point["tolerance_node_deviation_m"] = result["tolerance/node_deviation_m"]
        cell["tolerance_cable_share"] = result["tolerance/cable_share"]
    for read in [by_h5py] + ([by_vtk] if vtk else []):
        points, ends, in_points, in_cells = read(path)
        same("points", points, last["position_m"][:])
        same("ends", ends, scene["cable/end"][:])
        for mine, theirs in ((in_points, point), (in_cells, cell)):
            assert mine.keys() == theirs.keys(), mine.keys() ^ theirs.keys()
            for name, values in theirs.items():
                same(name, mine[name], values[:])
    for grid, mine in (("PointData", point), ("CellData", cell)):  # one copy in the file, under two names
        for name, values in mine.items():
            assert (result["VTKHDF"][grid][name] == values) == (name not in ("role", "group")), name
    for name, shape in shapes.items() if vtk else ():
        same(name, by_calculator(path, f"{name}_position_m"), shape["position_m"][:])
    print(" ".join(sorted(shapes)))


def main(result_path, folder=None):
    if not folder:
        check_result(result_path)
        return
    result = h5py.File(result_path, "r")
    stages = {"target": None, "form": "form"}
    if "search/position_m" in result:
        stages["search"] = "search"
    if "refine" in result:
        stages["refine"] = "refine"
    if any(stage.attrs["n_facet"] for stage in result["surface"].values() if isinstance(stage, h5py.Group)
           ) if "surface" in result else False:
        stages.update({f"{name}_facets": stage for name, stage in stages.items()})
    if "truss" in result:
        stages["truss"] = "truss"
    assert sorted(os.listdir(folder)) == sorted(f"{name}.hdf" for name in stages), os.listdir(folder)
    for name, stage in stages.items():
        for read in [by_h5py] + ([by_vtk] if vtk else []):
            of = check_truss if name == "truss" else check_facets if name.endswith("_facets") else check
            of(result, f"{folder}/{name}.hdf", stage, read)
    print(" ".join(sorted(stages)))


main(*sys.argv[1:])
