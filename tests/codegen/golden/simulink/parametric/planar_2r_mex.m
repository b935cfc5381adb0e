function planar_2r_mex()
%PLANAR_2R_MEX  Compiles the S-functions.
folder = cd(fileparts(mfilename('fullpath')));
back = onCleanup(@() cd(folder));
mex('planar_2r_dynamics_sfun.c', 'planar_2r.c');
mex('planar_2r_inverse_dynamics_sfun.c', 'planar_2r.c');
end
