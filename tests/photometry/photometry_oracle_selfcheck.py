"""Checks of photometry_oracle.py on made-up files with known answers (writes them to a temporary folder)."""
import atexit, math, os, shutil, sys, tempfile
sys.path.insert(0,os.path.dirname(os.path.abspath(__file__))); import photometry_oracle as o
T=tempfile.mkdtemp(); atexit.register(shutil.rmtree,T)
def put(name,text):
    p=os.path.join(T,name); open(p,'w',newline='').write(text); return o.examine(p)
def ies(kind,V,H,f,head='IESNA:LM-63-2002\n',tilt='NONE',second='1 1 10',mult=1,sep=' '):
    n={'C':1,'B':2,'A':3}[kind]
    rows='\n'.join(sep.join(repr(f(v,h)) for v in V) for h in H)
    return f"{head}TILT={tilt}\n1 1000 {mult} {len(V)} {len(H)} {n} 1 1 2 0\n{second}\n{sep.join(map(str,V))}\n{sep.join(map(str,H))}\n{rows}\n"
R=lambda a,b,s:[a+s*k for k in range(int((b-a)/s)+1)]
close=lambda a,b,t=1e-9: abs(a-b)<=t*max(1,abs(b))
failed=[]
def ok(c,what):
    print('ok  ' if c else 'FAIL',what); failed.extend([] if c else [what])
iso=lambda v,h:100.0
r=put('c.ies',ies('C',R(0,180,10),R(0,360,30),iso)); ok(close(r['flux_lm'],400*math.pi),'C isotropic')
r=put('a.ies',ies('A',R(-90,90,10),R(-180,180,30),iso)); ok(close(r['flux_lm'],400*math.pi),'A isotropic')
r=put('a2.ies',ies('A',R(-90,90,10),R(0,90,30),iso)); ok(close(r['flux_lm'],200*math.pi),'A half, mirrored')
r=put('b.ies',ies('B',R(-90,90,10),R(-90,90,30),iso)); ok(close(r['flux_lm'],200*math.pi),'B half')
r=put('b2.ies',ies('B',R(-90,0,10),R(0,90,30),iso)); ok(close(r['flux_lm'],100*math.pi),'B quarter, mirrored')
ok(all(close(p['cd'],100.0 if p['direction'][2]<=0 and p['direction'][0]<=0 else 0) for p in r['probes']),'B quarter: only -z, -x lit')
# one smooth distribution given in all three types must give the same flux and probes
f=lambda d: 100*math.exp(2*d[0]-1.5*d[1])*max(0,1)
def probe_err(r): return max(abs(p['cd']-f(p['direction'])*(1 if r['_lit'](p['direction']) else 0))/f(p['direction']) for p in r['probes'])
s,c=lambda a:math.sin(math.radians(a)),lambda a:math.cos(math.radians(a))
A=lambda v,h:f((c(v)*c(h),-c(v)*s(h),s(v))); B=lambda v,h:f((c(h)*s(v),-s(h),-c(h)*c(v))); C=lambda v,h:f((s(v)*c(h),s(v)*s(h),-c(v)))
rc=put('c3.ies',ies('C',R(0,180,1),R(0,360,1),C)); rc['_lit']=lambda d:True
ra=put('a3.ies',ies('A',R(-90,90,1),R(-180,180,1),A)); ra['_lit']=lambda d:True
rb=put('b3.ies',ies('B',R(-90,90,1),R(-90,90,1),B)); rb['_lit']=lambda d:d[2]<=0
k=2.5; ok(close(rc['flux_lm'],400*math.pi*math.sinh(k)/k,2e-4) and close(rc['flux_lm'],ra['flux_lm'],1e-4),'C = A = closed form %g %g %g'%(rc['flux_lm'],ra['flux_lm'],400*math.pi*math.sinh(k)/k))
ok(max(map(probe_err,(rc,ra,rb)))<2e-3,'probes of A, B, C agree with the function')
ok(close(2*rb['flux_lm'],rc['flux_lm'],1e-4),'B: lower half is half')
# exactness of the quadrature: I = gamma in degrees, from 0 to 180 -> 2 pi * pi in radians
r=put('lin.ies',ies('C',[0,180],[0],lambda v,h:math.radians(v))); ok(close(r['flux_lm'],2*math.pi*math.pi),'linear in gamma exact')
# symmetries: quadrant, 0-180, 90-270 against full
g=lambda v,h: 50+v*abs(c(h)) + 0*h
for H,n in ((R(0,90,15),'0-90'),(R(0,180,15),'0-180'),(R(90,270,15),'90-270'),(R(0,345,15),'0-345')):
    q=put('q.ies',ies('C',R(0,90,5),H,g)); full=put('f.ies',ies('C',R(0,90,5),R(0,360,15),g))
    ok(close(q['flux_lm'],full['flux_lm']) and all(close(x['cd'],y['cd']) for x,y in zip(q['probes'],full['probes'])),n)
# tilt, factors, feet, delimiters, versions
t="1\n3\n0 45 90\n1 .9 .8\n"
base=ies('C',R(0,90,30),[0],iso)
r=put('t.ies',base.replace('TILT=NONE\n','TILT=INCLUDE\n'+t)); ok(r.get('tilt',{}).get('factors')==[1,.9,.8] and close(r['flux_lm'],200*math.pi),'TILT=INCLUDE')
open(os.path.join(T,'lamp.tlt'),'w').write(t)
r=put('t2.ies',base.replace('NONE','lamp.tlt')); ok(r['tilt']['angles']==[0,45,90],'TILT=file')
r=put('t3.ies',base.replace('NONE','gone.tlt')); ok('error' not in r and r['notes'],'TILT=missing file: noted')
r=put('v86.ies',ies('C',R(0,90,30),[0],iso,head='Some luminaire\nlabel 2\n',second='.5 .8 10',mult=2)); ok(close(r['peak_cd'],80) and r['format']=='LM-63-1986','1986, both ballast factors')
r=put('v19.ies',ies('C',R(0,90,30),[0],iso,head='IES:LM-63-2019\n',second='.5 1.10000 10',mult=2)); ok(close(r['peak_cd'],100) and r['format']=='LM-63-2019','2019, file generation type not a factor')
r=put('com.ies',ies('C',R(0,90,30),[0],iso,sep=', ')); ok('error' not in r,'comma delimiters')
ft=put('ft.ies',base); ok(ft['opening_m']=={'width':.3048,'length':.6096,'height':0},'feet')
# refusals
L=base.split('\n')
for name,text,line in (('no tilt',base.replace('TILT=NONE\n',''),len(L)-2),('short',base.rstrip().rsplit(' ',1)[0],7),('extra',base+'5\n',8),
    ('word',base.replace('0 30','0 3o'),5),('descend',base.replace('30 60','60 30'),5),('type 4',base.replace(' 4 1 1 1 ',' 4 1 4 1 '),3),
    ('units 3',base.replace(' 4 1 1 1 ',' 4 1 1 3 '),3),('count',base.replace(' 4 1 1 1 ',' 4.5 1 1 1 '),3),('nan',base.replace('100.0','nan',1),7),('empty','',1)):
    r=put('bad.ies',text); ok(r.get('line')==line,'refuse %s: %s, line %s'%(name,r.get('error'),r.get('line')))
# LDT
def ldt(isym,Cs,G,fn,planes,flux=2000,sets=1,lamps=1,conv=1):
    head=['x',1,isym,len(Cs),0,len(G),0,'','','','','',10,10,10,400,200,1,2,3,4,100,100,conv,0,sets]
    for k in range(sets): head+=[lamps,'',flux*(k+1),'','','10']
    return '\r\n'.join(map(str,head+[0]*10+Cs+G+[repr(fn(v,h)) for h in planes for v in G]))+'\r\n'
G=R(0,180,5); Cs=R(0,345,15)
ref={}
for isym,planes,fn in ((0,Cs,C),(1,[0],lambda v,h:v+1.),(2,R(0,180,15),lambda v,h:50+v*c(h)),(3,R(270,360,15)+R(15,90,15),lambda v,h:300+v*s(h)),(4,R(0,90,15),g)):
    r=put('x.ldt',ldt(isym,Cs,G,fn,planes,sets=2)); full=put('y.ldt',ldt(0,Cs,G,fn,Cs))
    ok(close(r['flux_lm'],full['flux_lm']) and all(close(x['cd'],y['cd']) for x,y in zip(r['probes'],full['probes'])),'LDT Isym %d'%isym)
r=put('n.ldt',ldt(1,[0],G,iso,[0],lamps=-1,conv='0,5')); ok(r['absolute'] and close(r['peak_cd'],100) and r['opening_m']=={'width':.2,'length':.4,'height':.004},'LDT absolute, comma decimal, opening')
good=ldt(4,Cs,G,iso,R(0,90,15))
for name,text in (('short',good.rstrip().rsplit('\r\n',1)[0]),('extra',good+'3\r\n'),('Isym 5',good.replace('\r\n4\r\n','\r\n5\r\n',1)),('word',good.replace('400','4oo')),('Mc',ldt(4,R(0,350,10)[:-1],G,iso,R(0,90,10))),('planes',ldt(4,R(1,346,15),G,iso,R(0,90,15)))):
    r=put('bad.ldt',text); ok('error' in r,'refuse LDT %s: %s, line %s'%(name,r.get('error'),r.get('line')))
sys.exit(len(failed)>0)
