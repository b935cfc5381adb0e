function failed = planar_2r_selftest(folder)
%PLANAR_2R_SELFTEST  1 where a result misses the vectors, else 0.
if nargin < 1
    folder = fullfile(fileparts(mfilename('fullpath')), 'vectors');
end
lastwarn('');
failed = false;
failed = failed | dynamics_(folder);
failed = failed | inverse_dynamics_(folder);
failed = double(failed || ~isempty(lastwarn()));
end

function failed = dynamics_(folder)
rows = load(fullfile(folder, 'dynamics.txt'), '-ascii');
worst = 0;
for k = 1:size(rows, 1)
    row = rows(k, :);
    q = row(1:2);
    qdot = row(3:4);
    params.m1 = row(5);
    params.m2 = row(6);
    params.l1 = row(7);
    params.lc1 = row(8);
    params.lc2 = row(9);
    params.I1 = row(10);
    params.I2 = row(11);
    params.g0 = row(12);
    params.l2 = row(13);
    if k == 1 && ~isequal(params, planar_2r_params())  % which the first row holds
        worst = Inf;
    end
    [M, Cqdot, g] = planar_2r_dynamics(q, qdot, params);
    worst = worse(worst, permute(M, [2 1]), row(14:17), row(22));
    worst = worse(worst, Cqdot, row(18:19), row(23));
    worst = worse(worst, g, row(20:21), row(24));
end
failed = report('dynamics', rows, 24, worst);
end

function failed = inverse_dynamics_(folder)
rows = load(fullfile(folder, 'inverse_dynamics.txt'), '-ascii');
worst = 0;
for k = 1:size(rows, 1)
    row = rows(k, :);
    q = row(1:2);
    qdot = row(3:4);
    qddot = row(5:6);
    params.m1 = row(7);
    params.m2 = row(8);
    params.l1 = row(9);
    params.lc1 = row(10);
    params.lc2 = row(11);
    params.I1 = row(12);
    params.I2 = row(13);
    params.g0 = row(14);
    params.l2 = row(15);
    if k == 1 && ~isequal(params, planar_2r_params())  % which the first row holds
        worst = Inf;
    end
    [tau] = planar_2r_inverse_dynamics(q, qdot, qddot, params);
    worst = worse(worst, tau, row(16:17), row(18));
end
failed = report('inverse_dynamics', rows, 18, worst);
end

function worst = worse(worst, got, want, scale)
% The largest error in units in the last place of the scale; infinite where a result is NaN.
errors = abs(got(:)' - want)/(scale*eps);
if any(isnan(errors))
    errors = Inf;
end
worst = max([worst, errors]);
end

function failed = report(name, rows, width, worst)
fprintf('%s: %d states, largest error %.3g ulp\n', name, size(rows, 1), worst);
failed = ~(size(rows, 1) > 0 && size(rows, 2) == width && worst <= 32);
end
