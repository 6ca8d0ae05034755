// A scene of Three.js with a brume server's medium in it: three.html?src=http://clouds.example:8080/
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { SharedMedium } from './shared-medium';

const renderer = new THREE.WebGLRenderer();
renderer.setClearColor(0, 0); // where nothing is drawn there is brume's sky
document.body.append(renderer.domElement);
const target = new THREE.WebGLRenderTarget(1, 1, {
  type: THREE.HalfFloatType,
  depthTexture: new THREE.DepthTexture(1, 1),
});
const camera = new THREE.PerspectiveCamera(50, 1, 0.1, 2000);
const controls = new OrbitControls(camera, renderer.domElement);

const scene = new THREE.Scene();
const [sun, skyLight] = [new THREE.DirectionalLight(), new THREE.HemisphereLight()];
const knot = new THREE.Mesh(new THREE.TorusKnotGeometry(), new THREE.MeshStandardMaterial({ color: 0xd04020 }));
const ground = new THREE.Mesh(new THREE.CircleGeometry(1500, 96), new THREE.MeshStandardMaterial({ color: 0x507040 }));
scene.add(sun, skyLight, knot, ground.rotateX(-Math.PI / 2));

const gl = renderer.getContext() as WebGL2RenderingContext;
const medium = new SharedMedium(gl, new URLSearchParams(location.search).get('src') ?? location.href);
void medium.welcome.then(({ camera: first }) => {
  camera.position.set(...first.position);
  controls.target.set(...first.target);
  const size = camera.position.distanceTo(controls.target) / 12;
  knot.position.copy(controls.target);
  knot.scale.setScalar(size);
  ground.position.copy(controls.target).y -= 4 * size;
});

const textureOf = (texture: THREE.Texture): WebGLTexture =>
  (renderer.properties.get(texture) as { __webglTexture: WebGLTexture }).__webglTexture;

renderer.setAnimationLoop(() => {
  const [width, height] = [window.innerWidth, window.innerHeight];
  if (target.width !== width || target.height !== height) {
    renderer.setSize(width, height);
    target.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
  }
  if (medium.light) {
    const { toLight, irradiance, zenith, horizon } = medium.light;
    sun.position.set(...toLight);
    sun.color.setRGB(...irradiance);
    skyLight.color.setRGB(...zenith).multiplyScalar(Math.PI);
    skyLight.groundColor.setRGB(...horizon).multiplyScalar(Math.PI);
  }
  controls.update();
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const drawn = { colour: textureOf(target.texture), depth: textureOf(target.depthTexture as THREE.Texture) };
  const matrices = { projection: camera.projectionMatrix.elements, world: camera.matrixWorld.elements };
  medium.draw(matrices, drawn, { framebuffer: null, x: 0, y: 0, width, height });
  renderer.resetState();
});

Object.assign(window, { example: { medium, camera, controls, knot } }); // for the browser's console, and for tests
