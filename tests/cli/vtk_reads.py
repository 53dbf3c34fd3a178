"""vtk_reads.py RESULT FOLDER: VTK (python3-vtk9) reads every file of `hifdm export --vtk`, and point and cell data are
the numbers of the result file, bit by bit. Without VTK h5py looks at the same files, which is no proof that VTK can."""
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

LAWS = ["tension", "length", "force_density", "elastic"]


def by_vtk(path):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetClassName() == "vtkUnstructuredGrid", grid
    ends = []
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        assert cell.GetCellType() == vtk.VTK_LINE and cell.GetNumberOfPoints() == 2
        ends.append([cell.GetPointId(0), cell.GetPointId(1)])

    def arrays(data):
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    return (vtk_to_numpy(grid.GetPoints().GetData()), np.array(ends), arrays(grid.GetPointData()),
            arrays(grid.GetCellData()))


def by_h5py(path):
    grid = h5py.File(path, "r")["VTKHDF"]
    assert grid.attrs["Version"].tolist() == [1, 0] and grid.attrs["Type"] == b"UnstructuredGrid"
    points, ends = grid["Points"][:], grid["Connectivity"][:].reshape(-1, 2)
    assert grid["NumberOfPoints"][:].tolist() == [len(points)] and grid["NumberOfCells"][:].tolist() == [len(ends)]
    assert grid["NumberOfConnectivityIds"][:].tolist() == [2 * len(ends)]
    assert grid["Offsets"][:].tolist() == list(range(0, 2 * len(ends) + 1, 2))
    assert grid["Types"].dtype == np.uint8 and (grid["Types"][:] == 3).all()
    return (points, ends, {n: d[:] for n, d in grid["PointData"].items()},
            {n: d[:] for n, d in grid["CellData"].items()})


def same(name, one, other):
    one, other = np.asarray(one), np.asarray(other)
    assert one.shape == other.shape and one.astype(other.dtype).tobytes() == other.tobytes(), name


def check(result, path, stage, read):
    points, ends, point, cell = read(path)
    scene, theory = result["scene"], result["scene/node/position_m"][:]
    shape = result[stage] if stage else None
    same("points", points, shape["position_m"][:] if stage else theory)
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
    same("displacement_m", point["displacement_m"], shape["position_m"][:] - theory)
    moved = shape["position_m"][:] - theory
    same("deviation_m", point["deviation_m"], np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2 + moved[:, 2] ** 2))
    psi_m = np.sqrt((point["deviation_m"][point["role"] == 1] ** 2).mean())
    said_m = result["ga"].attrs["best_psi_m"] if stage == "ga/best" else shape.attrs["psi_m"]
    assert abs(psi_m - said_m) <= 1e-12 * psi_m + 1e-15, (psi_m, said_m)  # the order of a sum
    slack = result["form"].attrs["n_slack"] if stage == "form" else 0
    assert cell["slack"].sum() == slack, (cell["slack"].sum(), slack)
    if "surface" in result:
        group = {"form": "form", "ga/best": "optimize", "polish": "polish"}[stage]
        rms_m = np.sqrt((point["normal_error_m"][point["role"] == 1] ** 2).mean())
        assert abs(rms_m - result["surface"][group].attrs["normal_rms_m"]) <= 1e-12 * rms_m


def check_truss(result, path, read):
    points, ends, point, cell = read(path)
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


def main(result_path, folder):
    result = h5py.File(result_path, "r")
    stages = {"theoretical": None, "form": "form"}
    if "ga/best" in result:
        stages["optimize"] = "ga/best"
    if "polish" in result:
        stages["polish"] = "polish"
    if "truss" in result:
        stages["truss"] = "truss"
    assert sorted(os.listdir(folder)) == sorted(f"{name}.hdf" for name in stages), os.listdir(folder)
    for name, stage in stages.items():
        for read in [by_h5py] + ([by_vtk] if vtk else []):
            if name == "truss":
                check_truss(result, f"{folder}/{name}.hdf", read)
            else:
                check(result, f"{folder}/{name}.hdf", stage, read)
    print(" ".join(sorted(stages)))


main(*sys.argv[1:])
